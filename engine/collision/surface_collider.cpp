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
// Whether anything touches at all is decided to this.
constexpr double touch_tolerance_m = 1e-6;

// A lower bound of the tool's distance over a box.
double lower_bound(const ToolShape& tool, const SurfaceBounds::Box& box) {
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
double lower_bound(const ToolShape& tool, const std::array<Vector3, 4>& corners, double bulge) {
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

Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels) {
  NestedParameters in_u = nested_parameters(u, 1, levels), in_v = nested_parameters(v, 1, levels);
  Result<Grid> grid = make_grid(u, v, std::move(in_u.parameters), std::move(in_v.parameters));
  if (!grid.ok()) return grid.error();
  return NestedGrid{std::move(grid).value(), levels, levels};
}

SurfaceCollider::SurfaceCollider(const NestedGrid& nested)
    : nested_(&nested), bounds_(nested.grid.u.knots, nested.grid.v.knots) {
  const std::size_t count =
      static_cast<std::size_t>(nested.grid.rows()) * static_cast<std::size_t>(nested.grid.columns());
  samples_.resize(count);
  sampled_at_.assign(count, 0);
  near_at_.assign(count, 0);
  lines_.resize(static_cast<std::size_t>(nested.grid.u.knots.control_point_count()));
  column_bound_.assign(static_cast<std::size_t>(bounds_.elements_v()), 0.0);
  cells_.reserve(cell_capacity);
  finest_.reserve(cell_capacity);
  patches_.reserve(patch_capacity);
  near_.reserve(near_capacity);
}

const Vector3& SurfaceCollider::sample(const Surface& surface, int index) {
  if (sampled_at_[index] == query_) return samples_[index];
  const Grid& grid = nested_->grid;
  const BlendingMatrix& a_u = grid.u.values;
  const BlendingMatrix& a_v = grid.v.values;
  const int row = index / grid.columns(), column = index % grid.columns();
  Vector3 point = Vector3::Zero();
  for (int a = 0; a < a_u.bandwidth; ++a) {
    const int i = a_u.column(row, a);
    Vector3 line = Vector3::Zero();
    for (int b = 0; b < a_v.bandwidth; ++b) {
      line += a_v.values[column * a_v.bandwidth + b] * surface.net.point(i, a_v.column(column, b));
    }
    point += a_u.values[row * a_u.bandwidth + a] * line;
  }
  ++samples_evaluated_;
  samples_[index] = point;
  sampled_at_[index] = query_;
  return samples_[index];
}

// The coarsest samples of one column, which share their sums along v.
void SurfaceCollider::sample_column(const Surface& surface, int column) {
  const Grid& grid = nested_->grid;
  const BlendingMatrix& a_u = grid.u.values;
  const BlendingMatrix& a_v = grid.v.values;
  for (int i = 0; i < surface.net.rows; ++i) {
    lines_[i].setZero();
    for (int b = 0; b < a_v.bandwidth; ++b) {
      lines_[i] += a_v.values[column * a_v.bandwidth + b] * surface.net.point(i, a_v.column(column, b));
    }
  }
  for (int row = 0; row < grid.rows(); row += 1 << nested_->levels_u) {
    const int index = row * grid.columns() + column;
    if (sampled_at_[index] == query_) continue;
    Vector3 point = Vector3::Zero();
    for (int a = 0; a < a_u.bandwidth; ++a) {
      point += a_u.values[row * a_u.bandwidth + a] * lines_[a_u.column(row, a)];
    }
    ++samples_evaluated_;
    samples_[index] = point;
    sampled_at_[index] = query_;
  }
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
  samples_evaluated_ = 0;
  bounds_.begin();
  descend(surface, tool, margin_m, result);
  polish(surface, tool);
  result.samples_evaluated = samples_evaluated_;
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
void SurfaceCollider::offer_coarsest(const Surface& surface, const ToolShape& tool, double margin) {
  const Grid& grid = nested_->grid;
  const int stride_u = 1 << nested_->levels_u, stride_v = 1 << nested_->levels_v;
  const auto offer_column = [&](int j) {
    sample_column(surface, j);
    for (int i = 0; i < grid.rows(); i += stride_u) {
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], samples_[i * grid.columns() + j]);
    }
  };
  bounds_.take_boxes(surface.net);
  for (int e = 0; e < bounds_.elements_v(); ++e) column_bound_[e] = lower_bound(tool, bounds_.box(e));
  const auto nearest = std::min_element(column_bound_.begin(), column_bound_.end()) - column_bound_.begin();
  offer_column(static_cast<int>(nearest) * stride_v);
  offer_column((static_cast<int>(nearest) + 1) * stride_v);
  for (int e = 0; e < bounds_.elements_v(); ++e) {
    if (column_bound_[e] > reach(margin)) continue;
    offer_column(e * stride_v);
    offer_column((e + 1) * stride_v);
  }
}

void SurfaceCollider::descend(const Surface& surface, const ToolShape& tool, double margin,
                              CollisionResult& result) {
  const Grid& grid = nested_->grid;
  const int stride_u = 1 << nested_->levels_u, stride_v = 1 << nested_->levels_v;
  cells_.clear();
  finest_.clear();
  offer_coarsest(surface, tool, margin);
  for (int i = 0; i + stride_u < grid.rows(); i += stride_u) {
    for (int j = 0; j + stride_v < grid.columns(); j += stride_v) {
      if (column_bound_[j / stride_v] > reach(margin)) continue;
      if (cells_.size() < cell_capacity) {
        cells_.push_back({i, j, 0});
      } else {
        result.overflow = true;
      }
    }
  }
  // Breadth first: a coarse level's best distance prunes the finer ones.
  for (std::size_t at = 0; at < cells_.size(); ++at) {
    visit_cell(surface, tool, cells_[at], reach(margin), result);
  }
  for (const Cell& cell : finest_) {
    for (int corner = 0; corner < 4; ++corner) {
      const int index = (cell.i + (corner >> 1)) * grid.columns() + cell.j + (corner & 1);
      if (near_at_[index] == query_) continue;
      near_at_[index] = query_;
      const double distance = tool.distance(sample(surface, index));
      if (distance > margin) continue;
      if (near_.size() == near_capacity) {
        result.overflow = true;
        return;
      }
      near_.push_back({index, distance});
    }
  }
}

SurfaceCollider::Cover SurfaceCollider::cover(const Surface& surface, int i, int j, int level) {
  const Grid& grid = nested_->grid;
  const int step_u = 1 << std::max(0, nested_->levels_u - level),
            step_v = 1 << std::max(0, nested_->levels_v - level);
  const int index = i * grid.columns() + j;
  const std::array<Vector3, 4> corners = {sample(surface, index), sample(surface, index + step_v),
                                          sample(surface, index + step_u * grid.columns()),
                                          sample(surface, index + step_u * grid.columns() + step_v)};
  const Vector3 centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  double radius = 0.0;
  for (const Vector3& corner : corners) radius = std::max(radius, (corner - centre).norm());
  const double h_u = grid.u.parameters[i + step_u] - grid.u.parameters[i];
  const double h_v = grid.v.parameters[j + step_v] - grid.v.parameters[j];
  bounds_.update(surface.net, j >> nested_->levels_v);
  return {centre, radius + bounds_.bulge(i >> nested_->levels_u, j >> nested_->levels_v, h_u, h_v)};
}

void SurfaceCollider::visit_cell(const Surface& surface, const ToolShape& tool, const Cell& cell,
                                 double reach, CollisionResult& result) {
  const Cover sphere = cover(surface, cell.i, cell.j, cell.level);
  if (tool.distance(sphere.centre) - sphere.radius > reach) return;
  const Grid& grid = nested_->grid;
  const int step_u = 1 << std::max(0, nested_->levels_u - cell.level);
  const int step_v = 1 << std::max(0, nested_->levels_v - cell.level);
  if (step_u == 1 && step_v == 1) {
    finest_.push_back(cell);
    return;
  }
  const int half_u = std::max(1, step_u / 2), half_v = std::max(1, step_v / 2);
  for (int i = cell.i; i < cell.i + step_u; i += half_u) {
    for (int j = cell.j; j < cell.j + step_v; j += half_v) {
      if (cells_.size() == cell_capacity) {
        result.overflow = true;
        return;
      }
      cells_.push_back({i, j, cell.level + 1});
    }
  }
  for (int i = cell.i; i <= cell.i + step_u; i += half_u) {
    for (int j = cell.j; j <= cell.j + step_v; j += half_v) {
      offer(tool, grid.u.parameters[i], grid.v.parameters[j], sample(surface, i * grid.columns() + j));
    }
  }
}

// Branch and bound below the finest samples, over the cells that could still hide a nearer point.
void SurfaceCollider::search_between_samples(const Surface& surface, const ToolShape& tool,
                                             CollisionResult& result) {
  const Grid& grid = nested_->grid;
  for (const Cell& cell : finest_) {
    const int index = cell.i * grid.columns() + cell.j;
    patches_.clear();
    patches_.push_back(
        {grid.u.parameters[cell.i],
         grid.u.parameters[cell.i + 1],
         grid.v.parameters[cell.j],
         grid.v.parameters[cell.j + 1],
         {sample(surface, index), sample(surface, index + 1), sample(surface, index + grid.columns()),
          sample(surface, index + grid.columns() + 1)},
         cell.i >> nested_->levels_u,
         cell.j >> nested_->levels_v,
         0});
    while (!patches_.empty()) {
      const Patch patch = patches_.back();
      patches_.pop_back();
      const double bulge =
          bounds_.bulge(patch.element_u, patch.element_v, patch.u1 - patch.u0, patch.v1 - patch.v0);
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
