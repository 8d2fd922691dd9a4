#include "engine/collision/solids/surface_collider.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/solids/tool_shape.h"

namespace spoonbill {

TrimmedLevels::TrimmedLevels(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> area)
    : levels_(nested.levels),
      columns_(nested.grid.columns() - 1),
      area_(std::move(area)),
      cells_(GridLines(nested.grid.u), GridLines(nested.grid.v), *area_) {
  const Grid& grid = nested.grid;
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) present_samples_.push_back(contains(u, v) ? 1 : 0);
  }
  const int rows = grid.rows() - 1, width = columns_ + 1;
  present_.assign(static_cast<std::size_t>(rows + 1) * static_cast<std::size_t>(width), 0);
  const auto at = [&](int i, int j) -> int& { return present_[static_cast<std::size_t>(i * width + j)]; };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns_; ++j) {
      const int here = cells_.state(i, j) != TrimmedCells::State::away ? 1 : 0;
      at(i + 1, j + 1) = at(i, j + 1) + at(i + 1, j) - at(i, j) + here;
    }
  }
}

bool TrimmedLevels::is_trimmed_away(const LevelCell& cell) const {
  SPOONBILL_ASSERT_DEBUG(cell.level >= 0 && cell.level <= levels_);
  const int step = 1 << (levels_ - cell.level), width = columns_ + 1;
  const auto at = [&](int i, int j) { return present_[static_cast<std::size_t>(i * width + j)]; };
  return at(cell.i + step, cell.j + step) - at(cell.i, cell.j + step) - at(cell.i + step, cell.j) +
             at(cell.i, cell.j) ==
         0;
}

namespace {

constexpr std::size_t cell_capacity = 16384;
constexpr std::size_t patch_capacity = 512;
constexpr std::size_t near_capacity = 4096;
constexpr int deepest_patch = 24;
// Proven accuracy of the nearest distance, in metres. It is below the resolution of a haptic device (0.055
// mm). Newton's method itself is usually exact to the last digit. A smaller value would cost time, above all
// where surface and tool fit snugly and all points are equally near.
constexpr double nearest_tolerance_m = 2e-5;
// Proven accuracy of the nearest distance, in metres, for a solid of unknown concavity. For such a solid, the
// search must cut patches until they are as small as this accuracy.
constexpr double unbent_tolerance_m = 5e-5;
constexpr double clearance_fraction = 0.75;
// A Newton step that decreases the distance by less than this, in metres, makes no progress beyond rounding.
constexpr double least_gain_m = 1e-15;

double search_tolerance(const ToolShape& tool) {
  if (!tool.is_solid() || tool.distance_field->is_convex()) return nearest_tolerance_m;
  const Box bounds = tool.distance_field->bounds();
  const Vector3 far_m = bounds.high + (bounds.high - bounds.low);
  const bool is_concavity_known = std::isfinite(tool.distance_field->concavity(far_m, 0.0));
  return is_concavity_known ? nearest_tolerance_m : unbent_tolerance_m;
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
  update_best(tool, u, v, point);
}

void SurfaceCollider::update_best(const ToolShape& tool, double u, double v, const Vector3& point) {
  const double distance = tool.distance_within(point, best_.distance_m);
  if (distance >= best_.distance_m) return;
  best_ = {u, v, point, distance};
}

CollisionResult SurfaceCollider::collide(const Surface& surface, const ToolShape& tool, double margin_m,
                                         bool closed, const PlanarPoints& samples) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  SPOONBILL_ASSERT(!tool.is_solid() || tool.distance_field != nullptr);
  CollisionResult result;
  moved_ |= levels_.begin(surface, samples);
  find_nearest(tool, margin_m, Proof::deepest, result);
  collect_near_samples(tool, margin_m, result);
  result.nearest = contact_at(surface, best_);
  const double inside = closed ? depth_inside(tool, result.nearest) : 0.0;
  if (inside > 0.0) result.nearest.depth_m = inside;
  result.found = inside > 0.0 || best_.distance_m <= margin_m;
  return result;
}

void SurfaceCollider::find_nearest(const ToolShape& tool, double margin, Proof proof,
                                   CollisionResult& result) {
  ++query_;
  near_.clear();
  offer_last(tool);
  proof_ = proof;
  tolerance_ = search_tolerance(tool);
  cuts_left_ = surface_cut_limit;
  descend(tool, margin, result);
  if (trimmed_) offer_trim_loops(tool);
  polish(tool);
  result.samples_evaluated = levels_.samples_evaluated();
  for (const LevelCell& cell : finest_) search_between_samples(tool, cell, result.overflow);
  result.cuts = surface_cut_limit - cuts_left_;
  last_ = best_;
}

Clearance SurfaceCollider::clearance(const Surface& surface, const ToolShape& tool) {
  CollisionResult result;
  moved_ |= levels_.begin(surface);
  find_nearest(tool, 0.0, Proof::clearance, result);
  const bool touching = best_.distance_m <= touch_tolerance_m;
  return {touching ? 0.0 : clearance_fraction * best_.distance_m, contact_at(surface, best_),
          result.overflow};
}

// Returns the depth of a tool inside a closed surface along the normal of the nearest wall, or 0 if the tool
// is not inside. A sphere is inside if its centre is inside. A convex solid that touches the wall is inside
// if the centre of its bounds is inside; a non-convex solid that touches the wall never counts as inside. A
// solid that does not touch the wall is inside if its point nearest to the wall is inside.
double SurfaceCollider::depth_inside(const ToolShape& tool, const SurfaceContact& nearest) const {
  if (tool.kind == ToolShape::Kind::sphere) {
    const bool inside = (tool.centre_m - nearest.point_m).dot(nearest.normal) < 0.0;
    return inside ? std::max(2.0 * tool.radius_m + best_.distance_m, 0.0) : 0.0;
  }
  if (!tool.is_solid()) return 0.0;
  const Box bounds = tool.distance_field->bounds();
  if (!(bounds.size() < std::numeric_limits<double>::infinity())) return 0.0;
  Vector3 into_tool = -tool.at(nearest.point_m).gradient;
  if (!(best_.distance_m > 0.0)) {
    if (!tool.distance_field->is_convex()) return 0.0;
    into_tool = tool.centre_m + tool.turn * (0.5 * (bounds.low + bounds.high)) - nearest.point_m;
  }
  if (!(into_tool.dot(nearest.normal) < 0.0)) return 0.0;
  return std::max(depth_behind(tool, nearest.point_m, nearest.normal), -best_.distance_m);
}

// Compares the best point with the coarsest samples, except samples of elements that are too far away. The
// nearest column comes first, because its samples reduce the distance beyond which elements are too far.
void SurfaceCollider::offer_coarsest(const ToolShape& tool, double margin) {
  const Grid& grid = levels_.nested().grid;
  const int stride = levels_.step(0);
  const int last = levels_.bounds().elements_u() - 1;
  const auto offer_column = [&](int j) {
    levels_.sample_column(j);
    for (int i = 0; i < grid.rows(); i += stride) {
      // A sample between two elements belongs to both elements.
      const int after = std::min(i / stride, last), before = std::max(i / stride - 1, 0);
      if (std::min(row_bound_[before], row_bound_[after]) > reach(margin)) continue;
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  };
  SurfaceBounds& bounds = levels_.bounds();
  if (moved_) bounds.update_boxes(levels_.surface().net);
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

// Starts from the nearest point of the last query. This point is usually still almost the nearest, so that
// the search can skip most cells.
void SurfaceCollider::offer_last(const ToolShape& tool) {
  best_ = {};
  best_.distance_m = std::numeric_limits<double>::infinity();
  if (has_last_) offer(tool, last_.u, last_.v, position(levels_.pieces(), last_.u, last_.v));
  has_last_ = true;
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
      if (column_bound_[j / stride] > reach(margin) || is_trimmed_away({i, j, 0})) continue;
      if (cells_.size() < cell_capacity) {
        cells_.push_back({i, j, 0});
      } else {
        result.overflow = true;
      }
    }
  }
  // Visits cells breadth first. The best distance found at a coarse level then allows more cells of the finer
  // levels to be skipped.
  for (std::size_t at = 0; at < cells_.size(); ++at) visit_cell(tool, cells_[at], reach(margin), result);
}

void SurfaceCollider::collect_near_samples(const ToolShape& tool, double margin, CollisionResult& result) {
  const int columns = levels_.nested().grid.columns();
  for (const LevelCell& cell : finest_) {
    for (int corner = 0; corner < 4; ++corner) {
      const int index = (cell.i + (corner >> 1)) * columns + cell.j + (corner & 1);
      if (near_at_[index] == query_ || (trimmed_ && !trimmed_->has_sample(index))) continue;
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
  if (is_trimmed_away(cell)) return;
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
  // Only five of the 3 x 3 samples are new. The corners were compared when the cell was added.
  constexpr int between[5][2] = {{0, 1}, {1, 0}, {1, 1}, {1, 2}, {2, 1}};
  for (const auto& [in_u, in_v] : between) {
    const int i = cell.i + in_u * half, j = cell.j + in_v * half;
    offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
  }
}

// Returns the distance at or beyond which a patch can be skipped.
double SurfaceCollider::enough() const {
  const double best = best_.distance_m;
  if (proof_ == Proof::clearance) {
    return best > touch_tolerance_m ? clearance_fraction * best : -std::numeric_limits<double>::infinity();
  }
  return best >= 0.0 ? std::max(best - tolerance_, -touch_tolerance_m) : best - tolerance_;
}

// Searches a cell of the finest level for a nearer point between its samples, by branch and bound.
void SurfaceCollider::search_between_samples(const ToolShape& tool, const LevelCell& cell, bool& overflow) {
  if (is_cut(cell)) return search_trimmed_cell(tool, cell);
  patches_.clear();
  patches_.push_back(whole_patch(cell));
  while (!patches_.empty()) {
    const Patch patch = patches_.back();
    patches_.pop_back();
    const double needed = enough();
    if (lower_bound(tool, patch.corners, bulge(patch), needed) >= needed) continue;
    if (!can_cut(patch)) {
      overflow = true;
      continue;
    }
    const PatchCentre centre = find_centre(patch);
    const double before = best_.distance_m;
    offer(tool, centre.u, centre.v, centre.position_m);
    if (best_.distance_m < before) polish(tool);
    cut(patch, centre);
  }
}

SurfaceCollider::Patch SurfaceCollider::whole_patch(const LevelCell& cell) {
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

SurfaceCollider::PatchCentre SurfaceCollider::find_centre(const Patch& patch) const {
  const PiecewiseSurface pieces = levels_.pieces();
  PatchCentre centre;
  centre.u = 0.5 * (patch.u0 + patch.u1);
  centre.v = 0.5 * (patch.v0 + patch.v1);
  pieces.u->evaluate_values(centre.u, centre.basis_u);
  pieces.v->evaluate_values(centre.v, centre.basis_v);
  centre.position_m = position(pieces, centre.basis_u, centre.basis_v);
  return centre;
}

void SurfaceCollider::cut(const Patch& patch, const PatchCentre& at) {
  --cuts_left_;
  const PiecewiseSurface pieces = levels_.pieces();
  PieceBasis::Values u0, u1, v0, v1;
  pieces.u->evaluate_values(patch.u0, u0);
  pieces.u->evaluate_values(patch.u1, u1);
  pieces.v->evaluate_values(patch.v0, v0);
  pieces.v->evaluate_values(patch.v1, v1);
  const Vector3 low_u = position(pieces, u0, at.basis_v), high_u = position(pieces, u1, at.basis_v),
                low_v = position(pieces, at.basis_u, v0), high_v = position(pieces, at.basis_u, v1);
  const double u = at.u, v = at.v;
  const Vector3& centre = at.position_m;
  const auto& [p00, p01, p10, p11] = patch.corners;
  const int eu = patch.element_u, ev = patch.element_v, depth = patch.depth + 1;
  patches_.push_back({patch.u0, u, patch.v0, v, {p00, low_u, low_v, centre}, eu, ev, depth});
  patches_.push_back({patch.u0, u, v, patch.v1, {low_u, p01, centre, high_v}, eu, ev, depth});
  patches_.push_back({u, patch.u1, patch.v0, v, {low_v, centre, p10, high_u}, eu, ev, depth});
  patches_.push_back({u, patch.u1, v, patch.v1, {centre, high_v, high_u, p11}, eu, ev, depth});
}

void SurfaceCollider::polish(const ToolShape& tool) {
  const SurfaceSpot before = best_;
  if (tool.is_solid()) {
    best_ = polish_on_solid(levels_.surface(), tool, best_);
    if (trimmed_ && !trimmed_->contains(best_.u, best_.v)) best_ = before;
  } else {
    polish_analytic(tool);
  }
  // If Newton's method ended in another region, the previous point is restored.
  if (region_ >= 0 && region_at(best_.u, best_.v) != region_) best_ = before;
}

// Improves the parameters of the best point by Newton's method. A step that does not decrease the distance is
// halved. Where the curvature has the wrong sign, the step follows the gradient.
void SurfaceCollider::polish_analytic(const ToolShape& tool) {
  const Surface& surface = levels_.surface();
  const bool sphere = tool.kind == ToolShape::Kind::sphere;
  SurfacePoint at = evaluate(levels_.pieces(), best_.u, best_.v);
  for (int step = 0; step < 20; ++step) {
    const Vector3 towards = sphere ? Vector3(at.position_m - tool.centre_m) : tool.normal;
    const double gu = towards.dot(at.du), gv = towards.dot(at.dv);
    const double metric_u = at.du.squaredNorm(), metric_v = at.dv.squaredNorm(), metric_uv = at.du.dot(at.dv);
    const double fraction = sphere ? 1.0 : 0.0;
    double huu = fraction * metric_u + towards.dot(at.duu), hvv = fraction * metric_v + towards.dot(at.dvv);
    double huv = fraction * metric_uv + towards.dot(at.duv);
    if (!(huu > 0.0 && huu * hvv - huv * huv > 1e-12 * huu * std::abs(hvv))) {
      huu = metric_u + 1e-30;
      hvv = metric_v + 1e-30;
      huv = 0.0;
    }
    const double determinant = huu * hvv - huv * huv;
    double move_u = -(hvv * gu - huv * gv) / determinant, move_v = -(huu * gv - huv * gu) / determinant;
    if (!std::isfinite(move_u) || !std::isfinite(move_v)) return;
    // If the expected gain of a step is below rounding, the step is not halved.
    const double gain = -(move_u * gu + move_v * gv) / towards.norm();
    const int tries = gain > least_gain_m ? 12 : 1;
    const double before = best_.distance_m;
    for (int half = 0; half < tries && best_.distance_m >= before; ++half, move_u *= 0.5, move_v *= 0.5) {
      const double u = surface.u.into_domain(best_.u + move_u), v = surface.v.into_domain(best_.v + move_v);
      at = evaluate(levels_.pieces(), u, v);
      offer(tool, u, v, at.position_m);
    }
    if (!(best_.distance_m < before - least_gain_m)) return;
  }
}

namespace {

// Number of golden-section steps. They locate a minimum to 1e-4 of an edge's length.
constexpr int golden_section_steps = 20;
constexpr double golden_fraction = 0.6180339887498949;

Eigen::Vector2d point_on(const TrimmedArea::Edge& edge, double fraction) {
  return edge.from + fraction * (edge.to - edge.from);
}

}  // namespace

void SurfaceCollider::offer_trim_loops(const ToolShape& tool) {
  TrimEdges nearest;
  for (const LevelCell& cell : finest_) {
    if (!is_cut(cell)) continue;
    const Patch patch = whole_patch(cell);
    if (lower_bound(tool, patch.corners, bulge(patch), best_.distance_m) >= best_.distance_m) continue;
    offer_trim_edges(tool, cell, nearest);
  }
  minimise_on_edges(tool, nearest);
}

// Compares the best point with the start and the midpoint of each trim loop edge in the cell.
void SurfaceCollider::offer_trim_edges(const ToolShape& tool, const LevelCell& cell, TrimEdges& nearest) {
  const std::span<const TrimmedArea::Edge> edges = trimmed_->edges(cell);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const double fraction : {0.0, 0.5}) {
      const Eigen::Vector2d at = point_on(edges[e], fraction);
      const double before = best_.distance_m;
      update_best(tool, at.x(), at.y(), position(levels_.pieces(), at.x(), at.y()));
      if (!(best_.distance_m < before)) continue;
      const bool meets_last = fraction == 0.0 && e > 0 && edges[e - 1].to == edges[e].from;
      nearest = {&edges[e], meets_last ? &edges[e - 1] : nullptr};
    }
  }
}

// Minimises the distance along the nearest trim loop edge, and along the edge that meets it at the nearest
// point.
void SurfaceCollider::minimise_on_edges(const ToolShape& tool, const TrimEdges& nearest) {
  for (const TrimmedArea::Edge* edge : {nearest.first, nearest.second}) {
    if (edge == nullptr) continue;
    const auto distance = [&](double fraction) {
      const Eigen::Vector2d at = point_on(*edge, fraction);
      const Vector3 point = position(levels_.pieces(), at.x(), at.y());
      update_best(tool, at.x(), at.y(), point);
      return tool.distance(point);
    };
    double low = 0.0, high = 1.0;
    double inner = 1.0 - golden_fraction, outer = golden_fraction;
    double at_inner = distance(inner), at_outer = distance(outer);
    for (int step = 0; step < golden_section_steps; ++step) {
      if (at_inner < at_outer) {
        high = outer;
        outer = inner;
        at_outer = at_inner;
        inner = high - golden_fraction * (high - low);
        at_inner = distance(inner);
      } else {
        low = inner;
        inner = outer;
        at_inner = at_outer;
        outer = low + golden_fraction * (high - low);
        at_outer = distance(outer);
      }
    }
  }
}

// Searches a cell that trim loops cross. The result is not proven to be the nearest. Newton's method starts
// from the cell's centre if the centre is not trimmed away and is nearer than all corners, samples and loop
// points compared before.
void SurfaceCollider::search_trimmed_cell(const ToolShape& tool, const LevelCell& cell) {
  const Patch patch = whole_patch(cell);
  const double needed = enough();
  if (lower_bound(tool, patch.corners, bulge(patch), needed) >= needed) return;
  const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
  const double before = best_.distance_m;
  offer(tool, u, v, position(levels_.pieces(), u, v));
  if (best_.distance_m < before) polish(tool);
}

bool SurfaceCollider::touches_trimmed_cell(const ToolShape& tool, const LevelCell& cell) {
  const auto touches_at = [&](double u, double v) {
    return tool.distance_within(position(levels_.pieces(), u, v), 2.0 * touch_tolerance_m) <=
           touch_tolerance_m;
  };
  const Patch patch = whole_patch(cell);
  if (lower_bound(tool, patch.corners, bulge(patch), 0.0) > 0.0) return false;
  for (const double u : {patch.u0, 0.5 * (patch.u0 + patch.u1), patch.u1}) {
    for (const double v : {patch.v0, 0.5 * (patch.v0 + patch.v1), patch.v1}) {
      if (trimmed_->contains(u, v) && touches_at(u, v)) return true;
    }
  }
  for (const TrimmedArea::Edge& edge : trimmed_->edges(cell)) {
    if (touches_at(edge.from.x(), edge.from.y()) || touches_at(edge.to.x(), edge.to.y())) return true;
  }
  return false;
}

namespace {

// Largest number of patches that are cut in one search for regions.
constexpr int region_cut_capacity = 16000;

// Range of a region's cells in one direction.
struct CellRange {
  int low, high;  // indices of the first and the last cell

  void widen(int cell) {
    low = std::min(low, cell);
    high = std::max(high, cell);
  }
  double start(const GridDirection& direction) const { return direction.parameters[low]; }
  double end(const GridDirection& direction) const { return direction.parameters[high + 1]; }
};

}  // namespace

void SurfaceCollider::reserve_regions() {
  const Grid& grid = levels_.nested().grid;
  const std::size_t cells = static_cast<std::size_t>(grid.u.cell_count() * grid.v.cell_count());
  touched_index_.assign(cells, 0);
  touched_at_.assign(cells, 0);
  touched_.reserve(cells_.capacity());
  grouped_.reserve(cells_.capacity());
  regions_.reserve(tool_region_capacity);
}

int SurfaceCollider::finest_index(int i, int j) const {
  return i * levels_.nested().grid.v.cell_count() + j;
}

int SurfaceCollider::region_at(double u, double v) const {
  const Grid& grid = levels_.nested().grid;
  const int index = finest_index(grid.u.find_cell(u), grid.v.find_cell(v));
  return touched_at_[index] == query_ ? touched_[touched_index_[index]].region : -1;
}

// Returns true if the tool touches the surface in a cell. Cuts patches until a corner touches the tool or no
// patch can touch it.
bool SurfaceCollider::touches(const ToolShape& tool, const LevelCell& cell) {
  if (is_cut(cell)) return touches_trimmed_cell(tool, cell);
  patches_.clear();
  patches_.push_back(whole_patch(cell));
  while (!patches_.empty()) {
    const Patch patch = patches_.back();
    patches_.pop_back();
    for (const Vector3& corner : patch.corners) {
      if (tool.distance_within(corner, 2.0 * touch_tolerance_m) <= touch_tolerance_m) return true;
    }
    if (lower_bound(tool, patch.corners, bulge(patch), 0.0) > 0.0) continue;
    if (!can_cut(patch)) {
      regions_overflow_ = true;
      continue;
    }
    cut(patch, find_centre(patch));
  }
  return false;
}

void SurfaceCollider::find_touched_cells(const ToolShape& tool) {
  touched_.clear();
  for (const LevelCell& cell : finest_) {
    if (!touches(tool, cell)) continue;
    const int index = finest_index(cell.i, cell.j);
    touched_index_[index] = static_cast<int>(touched_.size());
    touched_at_[index] = query_;
    touched_.push_back({cell, -1});
  }
}

// Appends to grouped_ all touched cells that are connected with the cell `first`, also across a seam.
void SurfaceCollider::join_neighbours(int first, int region) {
  const Grid& grid = levels_.nested().grid;
  std::size_t next = grouped_.size();
  touched_[first].region = region;
  grouped_.push_back(first);
  for (; next < grouped_.size(); ++next) {
    const LevelCell cell = touched_[grouped_[next]].cell;
    for (int k = 0; k < 9; ++k) {
      const int i = grid.u.wrap_cell(cell.i + k / 3 - 1), j = grid.v.wrap_cell(cell.j + k % 3 - 1);
      if (i < 0 || j < 0) continue;
      const int index = finest_index(i, j);
      if (touched_at_[index] != query_) continue;
      TouchedCell& neighbour = touched_[touched_index_[index]];
      if (neighbour.region >= 0) continue;
      neighbour.region = region;
      grouped_.push_back(touched_index_[index]);
    }
  }
}

void SurfaceCollider::add_region(const ToolShape& tool, int begin, int end) {
  const Grid& grid = levels_.nested().grid;
  const LevelCell& first = touched_[grouped_[begin]].cell;
  CellRange along_u{first.i, first.i}, along_v{first.j, first.j};
  best_ = {};
  best_.distance_m = std::numeric_limits<double>::infinity();
  for (int k = begin; k < end; ++k) {
    const LevelCell& cell = touched_[grouped_[k]].cell;
    along_u.widen(cell.i);
    along_v.widen(cell.j);
    for (int corner = 0; corner < 4; ++corner) {
      const int i = cell.i + (corner >> 1), j = cell.j + (corner & 1);
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  }
  TrimEdges nearest_edges;
  for (int k = begin; k < end; ++k) {
    if (is_cut(touched_[grouped_[k]].cell)) offer_trim_edges(tool, touched_[grouped_[k]].cell, nearest_edges);
  }
  minimise_on_edges(tool, nearest_edges);
  region_ = touched_[grouped_[begin]].region;
  polish(tool);
  for (int k = begin; k < end; ++k) {
    search_between_samples(tool, touched_[grouped_[k]].cell, regions_overflow_);
  }
  region_ = -1;
  const ParameterRange range{along_u.start(grid.u), along_u.end(grid.u), along_v.start(grid.v),
                             along_v.end(grid.v)};
  regions_.push_back({range, contact_at(levels_.surface(), best_)});
}

const std::vector<ToolContactRegion>& SurfaceCollider::find_contact_regions(const ToolShape& tool) {
  regions_.clear();
  grouped_.clear();
  regions_overflow_ = false;
  proof_ = Proof::deepest;
  cuts_left_ = region_cut_capacity;
  find_touched_cells(tool);
  for (int k = 0; k < static_cast<int>(touched_.size()); ++k) {
    if (touched_[k].region >= 0) continue;
    if (regions_.size() == tool_region_capacity) {
      regions_overflow_ = true;
      break;
    }
    const int begin = static_cast<int>(grouped_.size());
    join_neighbours(k, static_cast<int>(regions_.size()));
    add_region(tool, begin, static_cast<int>(grouped_.size()));
  }
  std::sort(regions_.begin(), regions_.end(), [](const ToolContactRegion& a, const ToolContactRegion& b) {
    return std::tie(b.deepest.depth_m, a.deepest.u, a.deepest.v) <
           std::tie(a.deepest.depth_m, b.deepest.u, b.deepest.v);
  });
  return regions_;
}

}  // namespace spoonbill
