#include "engine/collision/surface_collider.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
// Below this, a step of Newton's method gains nothing but rounding.
constexpr double least_gain_m = 1e-15;

// A lower bound of the tool's distance over a box.
double lower_bound(const ToolShape& tool, const Box& box) {
  if (tool.kind == ToolShape::Kind::sphere) {
    return (tool.centre_m - tool.centre_m.cwiseMax(box.low).cwiseMin(box.high)).norm() - tool.radius_m;
  }
  const Vector3 foremost = (tool.normal.array() > 0.0).select(box.low, box.high);
  return tool.distance(foremost);
}

// A lower bound of the tool's distance over a patch: the bilinear patch lies in the hull of its corners, the
// surface within `bulge` of that, and no point of a hull is nearer than its foremost corner along any one
// direction. Unlike a ball's, this bound is off by the square of the patch's size, so that few patches are
// cut again.
double lower_bound(const ToolShape& tool, const PatchCorners& corners, double bulge) {
  Vector3 direction = tool.normal;
  if (tool.kind == ToolShape::Kind::sphere) {
    direction = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]) - tool.centre_m;
    const double length = direction.norm();
    if (!(length > 0.0)) return -tool.radius_m - bulge;
    direction /= length;
  }
  double foremost = std::numeric_limits<double>::infinity();
  for (const Vector3& corner : corners) foremost = std::min(foremost, direction.dot(corner - tool.centre_m));
  // Behind the centre the direction says nothing; the distance to a point is never below zero.
  if (tool.kind == ToolShape::Kind::sphere) foremost = std::max(foremost, 0.0);
  return foremost - tool.radius_m - bulge;
}

}  // namespace

SurfaceCollider::SurfaceCollider(const NestedGrid& nested) : levels_(nested) {
  const std::size_t count =
      static_cast<std::size_t>(nested.grid.rows()) * static_cast<std::size_t>(nested.grid.columns());
  near_at_.assign(count, 0);
  column_bound_.assign(static_cast<std::size_t>(levels_.bounds().elements_v()), 0.0);
  cells_.reserve(cell_capacity);
  finest_.reserve(cell_capacity);
  patches_.reserve(patch_capacity);
  near_.reserve(near_capacity);
}

double SurfaceCollider::reach(double margin) const {
  return std::max(margin, best_distance_);
}

void SurfaceCollider::offer(const ToolShape& tool, double u, double v, const Vector3& point) {
  const double distance = tool.distance(point);
  if (distance >= best_distance_) return;
  best_distance_ = distance;
  best_u_ = u;
  best_v_ = v;
  best_point_ = point;
}

CollisionResult SurfaceCollider::collide(const Surface& surface, const ToolShape& tool, double margin_m,
                                         bool closed) {
  CollisionResult result;
  ++query_;
  near_.clear();
  best_distance_ = std::numeric_limits<double>::infinity();
  levels_.begin(surface);
  descend(tool, margin_m, result);
  polish(surface, tool);
  result.samples_evaluated = levels_.samples_evaluated();
  search_between_samples(surface, tool, result);
  const Vector3 normal = unit_normal(surface, best_u_, best_v_);
  const bool inside =
      closed && tool.kind == ToolShape::Kind::sphere && (tool.centre_m - best_point_).dot(normal) < 0.0;
  const double depth = inside ? 2.0 * tool.radius_m + best_distance_ : -best_distance_;
  result.found = inside || best_distance_ <= margin_m;
  result.nearest = {best_u_, best_v_, best_point_, normal, depth};
  return result;
}

// The coarsest samples, but for elements too far for any to count: first along the nearest box, whose samples
// show how far that is.
void SurfaceCollider::offer_coarsest(const ToolShape& tool, double margin) {
  const Grid& grid = levels_.nested().grid;
  const int stride = levels_.step(0);
  const auto offer_column = [&](int j) {
    levels_.sample_column(j);
    for (int i = 0; i < grid.rows(); i += stride) {
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  };
  SurfaceBounds& bounds = levels_.bounds();
  bounds.take_boxes(levels_.surface().net);
  for (int e = 0; e < bounds.elements_v(); ++e) column_bound_[e] = lower_bound(tool, bounds.box(e));
  const auto nearest = std::min_element(column_bound_.begin(), column_bound_.end()) - column_bound_.begin();
  offer_column(static_cast<int>(nearest) * stride);
  offer_column((static_cast<int>(nearest) + 1) * stride);
  for (int e = 0; e < bounds.elements_v(); ++e) {
    if (column_bound_[e] > reach(margin)) continue;
    offer_column(e * stride);
    offer_column((e + 1) * stride);
  }
}

void SurfaceCollider::descend(const ToolShape& tool, double margin, CollisionResult& result) {
  const Grid& grid = levels_.nested().grid;
  const int stride = levels_.step(0);
  cells_.clear();
  finest_.clear();
  offer_coarsest(tool, margin);
  for (int i = 0; i + stride < grid.rows(); i += stride) {
    for (int j = 0; j + stride < grid.columns(); j += stride) {
      if (column_bound_[j / stride] > reach(margin)) continue;
      if (cells_.size() < cell_capacity) {
        cells_.push_back({i, j, 0});
      } else {
        result.overflow = true;
      }
    }
  }
  // Breadth first: a coarse level's best distance prunes the finer ones.
  for (std::size_t at = 0; at < cells_.size(); ++at) visit_cell(tool, cells_[at], reach(margin), result);
  take_near_samples(tool, margin, result);
}

void SurfaceCollider::take_near_samples(const ToolShape& tool, double margin, CollisionResult& result) {
  const int columns = levels_.nested().grid.columns();
  for (const LevelCell& cell : finest_) {
    for (int corner = 0; corner < 4; ++corner) {
      const int index = (cell.i + (corner >> 1)) * columns + cell.j + (corner & 1);
      if (near_at_[index] == query_) continue;
      near_at_[index] = query_;
      const double distance = tool.distance(levels_.sample(index));
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
  const CoverSphere sphere = levels_.cover(cell);
  if (tool.distance(sphere.centre) - sphere.radius > reach) return;
  if (levels_.is_finest(cell)) {
    finest_.push_back(cell);
    return;
  }
  const Grid& grid = levels_.nested().grid;
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
  for (int i = cell.i; i <= cell.i + step; i += half) {
    for (int j = cell.j; j <= cell.j + step; j += half) {
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], levels_.sample(i * grid.columns() + j));
    }
  }
}

// Branch and bound below the finest samples, over the cells that could still hide a nearer point.
void SurfaceCollider::search_between_samples(const Surface& surface, const ToolShape& tool,
                                             CollisionResult& result) {
  const Grid& grid = levels_.nested().grid;
  const int levels = levels_.nested().levels;
  for (const LevelCell& cell : finest_) {
    patches_.clear();
    patches_.push_back({grid.u.parameters[cell.i], grid.u.parameters[cell.i + 1], grid.v.parameters[cell.j],
                        grid.v.parameters[cell.j + 1], levels_.corners(cell), cell.i >> levels,
                        cell.j >> levels, 0});
    while (!patches_.empty()) {
      const Patch patch = patches_.back();
      patches_.pop_back();
      const double bulge =
          levels_.bounds().bulge(patch.element_u, patch.element_v, patch.u1 - patch.u0, patch.v1 - patch.v0);
      const double low = lower_bound(tool, patch.corners, bulge);
      const bool could_touch = best_distance_ >= 0.0 && low < -touch_tolerance_m;
      if (!could_touch && low >= best_distance_ - nearest_tolerance_m) continue;
      if (patch.depth == deepest_patch || patches_.size() + 4 > patch_capacity) {
        result.overflow = true;
        continue;
      }
      cut(surface, tool, patch);
    }
  }
}

void SurfaceCollider::cut(const Surface& surface, const ToolShape& tool, const Patch& patch) {
  const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
  const Vector3 centre = position(surface, u, v);
  const double before = best_distance_;
  offer(tool, u, v, centre);
  if (best_distance_ < before) polish(surface, tool);
  const Vector3 low_u = position(surface, patch.u0, v), high_u = position(surface, patch.u1, v),
                low_v = position(surface, u, patch.v0), high_v = position(surface, u, patch.v1);
  const auto& [p00, p01, p10, p11] = patch.corners;
  const int eu = patch.element_u, ev = patch.element_v, depth = patch.depth + 1;
  patches_.push_back({patch.u0, u, patch.v0, v, {p00, low_u, low_v, centre}, eu, ev, depth});
  patches_.push_back({patch.u0, u, v, patch.v1, {low_u, p01, centre, high_v}, eu, ev, depth});
  patches_.push_back({u, patch.u1, patch.v0, v, {low_v, centre, p10, high_u}, eu, ev, depth});
  patches_.push_back({u, patch.u1, v, patch.v1, {centre, high_v, high_u, p11}, eu, ev, depth});
}

// Newton's method on the parameters from the best point so far; a step that does not come nearer is halved,
// and the gradient takes over where the curvature has the wrong sign.
void SurfaceCollider::polish(const Surface& surface, const ToolShape& tool) {
  const bool sphere = tool.kind == ToolShape::Kind::sphere;
  SurfacePoint at = evaluate(surface, best_u_, best_v_);
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
    const double before = best_distance_;
    for (int half = 0; half < tries && best_distance_ >= before; ++half, move_u *= 0.5, move_v *= 0.5) {
      const double u = surface.u.into_domain(best_u_ + move_u), v = surface.v.into_domain(best_v_ + move_v);
      at = evaluate(surface, u, v);
      offer(tool, u, v, at.position_m);
    }
    if (!(best_distance_ < before - least_gain_m)) return;
  }
}

}  // namespace spoonbill
