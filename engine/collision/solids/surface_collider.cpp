#include "engine/collision/solids/surface_collider.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/collision/solids/tool_bounds.h"

namespace spoonbill {
namespace {

constexpr std::size_t cell_capacity = 16384;
constexpr std::size_t patch_capacity = 512;
constexpr std::size_t near_capacity = 4096;
constexpr int deepest_patch = 24;
// Newton's method usually finds the nearest point to the last digit. That no other is nearer is proven to
// this, less than a hand's device resolves (0.055 mm); a tighter bound costs most where surface and tool fit
// snugly and all points are as near.
constexpr double nearest_tolerance_m = 2e-5;
// For a solid of which no more is known than that its distance changes by at most the way moved: patches must
// then be cut to the size of the tolerance.
constexpr double unbent_tolerance_m = 5e-5;
// Of a solid's whole search, so that a tick has an end.
constexpr int cut_capacity = 20000;
constexpr double clearance_share = 0.75;
// Below this, a step of Newton's method gains nothing but rounding.
constexpr double least_gain_m = 1e-15;

double tolerance_of(const ToolShape& tool) {
  if (!tool.is_solid() || tool.made_of->is_convex()) return nearest_tolerance_m;
  const Box bounds = tool.made_of->bounds();
  const Vector3 far_m = bounds.high + (bounds.high - bounds.low);
  const bool bent = std::isfinite(tool.made_of->concavity(far_m, 0.0));
  return bent ? nearest_tolerance_m : unbent_tolerance_m;
}

}  // namespace

SurfaceCollider::SurfaceCollider(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> trim)
    : levels_(nested) {
  if (trim) trimmed_ = std::make_shared<const TrimmedLevels>(nested, std::move(trim));
  const std::size_t count =
      static_cast<std::size_t>(nested.grid.rows()) * static_cast<std::size_t>(nested.grid.columns());
  near_at_.assign(count, 0);
  column_bound_.assign(static_cast<std::size_t>(levels_.bounds().elements_v()), 0.0);
  row_bound_.assign(static_cast<std::size_t>(levels_.bounds().elements_u()), 0.0);
  cells_.reserve(cell_capacity);
  finest_.reserve(cell_capacity);
  patches_.reserve(patch_capacity);
  near_.reserve(near_capacity);
  reserve_regions();
}

double SurfaceCollider::reach(double margin) const {
  return std::max(margin, best_.distance_m);
}

void SurfaceCollider::offer(const ToolShape& tool, double u, double v, const Vector3& point) {
  if (trimmed_ && !trimmed_->contains(u, v)) return;
  take_nearer(tool, u, v, point);
}

void SurfaceCollider::take_nearer(const ToolShape& tool, double u, double v, const Vector3& point) {
  const double distance = tool.distance_within(point, best_.distance_m);
  if (distance >= best_.distance_m) return;
  best_ = {u, v, point, distance};
}

CollisionResult SurfaceCollider::collide(const Surface& surface, const ToolShape& tool, double margin_m,
                                         bool closed, const PlanarPoints& samples) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  SPOONBILL_ASSERT(!tool.is_solid() || tool.made_of != nullptr);
  CollisionResult result;
  moved_ |= levels_.begin(surface, samples);
  find_nearest(surface, tool, margin_m, Proof::deepest, result);
  take_near_samples(tool, margin_m, result);
  result.nearest = contact_at(surface, best_);
  const double inside = closed ? depth_inside(tool, result.nearest) : 0.0;
  if (inside > 0.0) result.nearest.depth_m = inside;
  result.found = inside > 0.0 || best_.distance_m <= margin_m;
  return result;
}

void SurfaceCollider::find_nearest(const Surface& surface, const ToolShape& tool, double margin, Proof proof,
                                   CollisionResult& result) {
  ++query_;
  near_.clear();
  offer_last(surface, tool);
  proof_ = proof;
  tolerance_ = tolerance_of(tool);
  cuts_left_ = tool.is_solid() ? cut_capacity : std::numeric_limits<int>::max();
  descend(tool, margin, result);
  if (trimmed_) offer_rims(surface, tool);
  polish(surface, tool);
  result.samples_evaluated = levels_.samples_evaluated();
  for (const LevelCell& cell : finest_) search_between_samples(surface, tool, cell, result.overflow);
  last_ = best_;
}

Clearance SurfaceCollider::clearance(const Surface& surface, const ToolShape& tool) {
  CollisionResult result;
  moved_ |= levels_.begin(surface);
  find_nearest(surface, tool, 0.0, Proof::clearance, result);
  const bool touching = best_.distance_m <= touch_tolerance_m;
  return {touching ? 0.0 : clearance_share * best_.distance_m, contact_at(surface, best_), result.overflow};
}

// How far a tool in the inside of a closed surface must go along the nearest wall's normal to be outside; 0
// where it is not inside. A sphere is inside with its centre. A convex solid that touches the wall is so with
// the middle of its bounds; one that touches nothing is where its nearest point is.
double SurfaceCollider::depth_inside(const ToolShape& tool, const SurfaceContact& nearest) const {
  if (tool.kind == ToolShape::Kind::sphere) {
    const bool inside = (tool.centre_m - nearest.point_m).dot(nearest.normal) < 0.0;
    return inside ? std::max(2.0 * tool.radius_m + best_.distance_m, 0.0) : 0.0;
  }
  if (!tool.is_solid()) return 0.0;
  const Box bounds = tool.made_of->bounds();
  if (!(bounds.size() < std::numeric_limits<double>::infinity())) return 0.0;
  Vector3 into_tool = -tool.at(nearest.point_m).gradient;
  if (!(best_.distance_m > 0.0)) {
    if (!tool.made_of->is_convex()) return 0.0;
    into_tool = tool.centre_m + tool.turn * (0.5 * (bounds.low + bounds.high)) - nearest.point_m;
  }
  if (!(into_tool.dot(nearest.normal) < 0.0)) return 0.0;
  return std::max(depth_behind(tool, nearest.point_m, nearest.normal), -best_.distance_m);
}

// The coarsest samples, but for elements too far for any to count: first along the nearest box, whose samples
// show how far that is.
void SurfaceCollider::offer_coarsest(const ToolShape& tool, double margin) {
  const Grid& grid = levels_.nested().grid;
  const int stride = levels_.step(0);
  const int last = levels_.bounds().elements_u() - 1;
  const auto offer_column = [&](int j) {
    levels_.sample_column(j);
    for (int i = 0; i < grid.rows(); i += stride) {
      // A sample belongs to the elements on either side.
      const int after = std::min(i / stride, last), before = std::max(i / stride - 1, 0);
      if (std::min(row_bound_[before], row_bound_[after]) > reach(margin)) continue;
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  };
  SurfaceBounds& bounds = levels_.bounds();
  if (moved_) bounds.take_boxes(levels_.surface().net);
  moved_ = false;
  for (int e = 0; e < bounds.elements_v(); ++e) column_bound_[e] = lower_bound(tool, bounds.box(e));
  for (int e = 0; e < bounds.elements_u(); ++e) row_bound_[e] = lower_bound(tool, bounds.row_box(e));
  const auto nearest = std::min_element(column_bound_.begin(), column_bound_.end()) - column_bound_.begin();
  offer_column(static_cast<int>(nearest) * stride);
  offer_column((static_cast<int>(nearest) + 1) * stride);
  for (int e = 0; e < bounds.elements_v(); ++e) {
    if (column_bound_[e] > reach(margin)) continue;
    offer_column(e * stride);
    offer_column((e + 1) * stride);
  }
}

// What was nearest in the query before mostly almost is so still: much of the rest need not be looked at.
void SurfaceCollider::offer_last(const Surface& surface, const ToolShape& tool) {
  best_ = {};
  best_.distance_m = std::numeric_limits<double>::infinity();
  if (asked_) offer(tool, last_.u, last_.v, position(surface, last_.u, last_.v));
  asked_ = true;
}

void SurfaceCollider::descend(const ToolShape& tool, double margin, CollisionResult& result) {
  const Grid& grid = levels_.nested().grid;
  const int stride = levels_.step(0);
  cells_.clear();
  finest_.clear();
  offer_coarsest(tool, margin);
  for (int i = 0; i + stride < grid.rows(); i += stride) {
    if (row_bound_[i / stride] > reach(margin)) continue;
    for (int j = 0; j + stride < grid.columns(); j += stride) {
      if (column_bound_[j / stride] > reach(margin) || is_away({i, j, 0})) continue;
      if (cells_.size() < cell_capacity) {
        cells_.push_back({i, j, 0});
      } else {
        result.overflow = true;
      }
    }
  }
  // Breadth first: a coarse level's best distance prunes the finer ones.
  for (std::size_t at = 0; at < cells_.size(); ++at) visit_cell(tool, cells_[at], reach(margin), result);
}

void SurfaceCollider::take_near_samples(const ToolShape& tool, double margin, CollisionResult& result) {
  const int columns = levels_.nested().grid.columns();
  for (const LevelCell& cell : finest_) {
    for (int corner = 0; corner < 4; ++corner) {
      const int index = (cell.i + (corner >> 1)) * columns + cell.j + (corner & 1);
      if (near_at_[index] == query_ || (trimmed_ && !trimmed_->keeps_sample(index))) continue;
      near_at_[index] = query_;
      const double distance = tool.distance_within(levels_.sample(index), margin + touch_tolerance_m);
      if (distance > margin) continue;
      if (near_.size() == near_capacity) {
        result.overflow = true;
        return;
      }
      near_.push_back({index, distance});
    }
  }
}

void SurfaceCollider::visit_cell(const ToolShape& tool, const LevelCell& cell, double reach,
                                 CollisionResult& result) {
  if (is_away(cell)) return;
  const CoverSphere sphere = levels_.cover(cell);
  if (tool.is_beyond(sphere.centre, sphere.radius, std::max(reach, 0.0))) return;
  if (levels_.is_finest(cell)) {
    finest_.push_back(cell);
    return;
  }
  const Grid& grid = levels_.nested().grid;
  levels_.sample_element(cell.i >> levels_.nested().levels, cell.j >> levels_.nested().levels);
  const int step = levels_.step(cell.level), half = step / 2;
  for (int i = cell.i; i < cell.i + step; i += half) {
    for (int j = cell.j; j < cell.j + step; j += half) {
      if (cells_.size() == cell_capacity) {
        result.overflow = true;
        return;
      }
      cells_.push_back({i, j, cell.level + 1});
    }
  }
  // Its corners were offered when it was found.
  constexpr int between[5][2] = {{0, 1}, {1, 0}, {1, 1}, {1, 2}, {2, 1}};
  for (const auto& [in_u, in_v] : between) {
    const int i = cell.i + in_u * half, j = cell.j + in_v * half;
    offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
  }
}

// The bound from which a patch hides nothing that counts.
double SurfaceCollider::enough() const {
  const double best = best_.distance_m;
  if (proof_ == Proof::clearance) {
    return best > touch_tolerance_m ? clearance_share * best : -std::numeric_limits<double>::infinity();
  }
  return best >= 0.0 ? std::max(best - tolerance_, -touch_tolerance_m) : best - tolerance_;
}

// Branch and bound below the finest samples of a cell that could still hide a nearer point.
void SurfaceCollider::search_between_samples(const Surface& surface, const ToolShape& tool,
                                             const LevelCell& cell, bool& overflow) {
  if (is_cut(cell)) return search_cut_cell(surface, tool, cell);
  patches_.clear();
  patches_.push_back(whole(cell));
  while (!patches_.empty()) {
    const Patch patch = patches_.back();
    patches_.pop_back();
    const double needed = enough();
    if (lower_bound(tool, patch.corners, bulge(patch), needed) >= needed) continue;
    if (!can_cut(patch)) {
      overflow = true;
      continue;
    }
    const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
    const Vector3 centre = position(surface, u, v);
    const double before = best_.distance_m;
    offer(tool, u, v, centre);
    if (best_.distance_m < before) polish(surface, tool);
    cut(surface, patch, centre);
  }
}

SurfaceCollider::Patch SurfaceCollider::whole(const LevelCell& cell) {
  const Grid& grid = levels_.nested().grid;
  const int levels = levels_.nested().levels;
  return {grid.u.parameters[cell.i], grid.u.parameters[cell.i + 1],
          grid.v.parameters[cell.j], grid.v.parameters[cell.j + 1],
          levels_.corners(cell),     cell.i >> levels,
          cell.j >> levels,          0};
}

double SurfaceCollider::bulge(const Patch& patch) {
  return levels_.bounds().bulge(patch.element_u, patch.element_v, patch.u1 - patch.u0, patch.v1 - patch.v0);
}

bool SurfaceCollider::can_cut(const Patch& patch) const {
  return patch.depth < deepest_patch && patches_.size() + 4 <= patch_capacity && cuts_left_ > 0;
}

void SurfaceCollider::cut(const Surface& surface, const Patch& patch, const Vector3& centre) {
  --cuts_left_;
  const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
  const Vector3 low_u = position(surface, patch.u0, v), high_u = position(surface, patch.u1, v),
                low_v = position(surface, u, patch.v0), high_v = position(surface, u, patch.v1);
  const auto& [p00, p01, p10, p11] = patch.corners;
  const int eu = patch.element_u, ev = patch.element_v, depth = patch.depth + 1;
  patches_.push_back({patch.u0, u, patch.v0, v, {p00, low_u, low_v, centre}, eu, ev, depth});
  patches_.push_back({patch.u0, u, v, patch.v1, {low_u, p01, centre, high_v}, eu, ev, depth});
  patches_.push_back({u, patch.u1, patch.v0, v, {low_v, centre, p10, high_u}, eu, ev, depth});
  patches_.push_back({u, patch.u1, v, patch.v1, {centre, high_v, high_u, p11}, eu, ev, depth});
}

void SurfaceCollider::polish(const Surface& surface, const ToolShape& tool) {
  const SurfaceSpot before = best_;
  if (tool.is_solid()) {
    best_ = polished_on_solid(surface, tool, best_);
    if (trimmed_ && !trimmed_->contains(best_.u, best_.v)) best_ = before;
  } else {
    polish_by_form(surface, tool);
  }
  // It may have come down elsewhere.
  if (region_ >= 0 && region_at(best_.u, best_.v) != region_) best_ = before;
}

// Newton's method on the parameters from the best point so far; a step that does not come nearer is halved,
// and the gradient takes over where the curvature has the wrong sign.
void SurfaceCollider::polish_by_form(const Surface& surface, const ToolShape& tool) {
  const bool sphere = tool.kind == ToolShape::Kind::sphere;
  SurfacePoint at = evaluate(surface, best_.u, best_.v);
  for (int step = 0; step < 20; ++step) {
    const Vector3 towards = sphere ? Vector3(at.position_m - tool.centre_m) : tool.normal;
    const double gu = towards.dot(at.du), gv = towards.dot(at.dv);
    const double metric_u = at.du.squaredNorm(), metric_v = at.dv.squaredNorm(), metric_uv = at.du.dot(at.dv);
    const double share = sphere ? 1.0 : 0.0;
    double huu = share * metric_u + towards.dot(at.duu), hvv = share * metric_v + towards.dot(at.dvv);
    double huv = share * metric_uv + towards.dot(at.duv);
    if (!(huu > 0.0 && huu * hvv - huv * huv > 1e-12 * huu * std::abs(hvv))) {
      huu = metric_u + 1e-30;
      hvv = metric_v + 1e-30;
      huv = 0.0;
    }
    const double determinant = huu * hvv - huv * huv;
    double move_u = -(hvv * gu - huv * gv) / determinant, move_v = -(huu * gv - huv * gu) / determinant;
    if (!std::isfinite(move_u) || !std::isfinite(move_v)) return;
    // Where no more than rounding can be gained, the last step is not worth halving.
    const double gain = -(move_u * gu + move_v * gv) / towards.norm();
    const int tries = gain > least_gain_m ? 12 : 1;
    const double before = best_.distance_m;
    for (int half = 0; half < tries && best_.distance_m >= before; ++half, move_u *= 0.5, move_v *= 0.5) {
      const double u = surface.u.into_domain(best_.u + move_u), v = surface.v.into_domain(best_.v + move_v);
      at = evaluate(surface, u, v);
      offer(tool, u, v, at.position_m);
    }
    if (!(best_.distance_m < before - least_gain_m)) return;
  }
}

}  // namespace spoonbill
