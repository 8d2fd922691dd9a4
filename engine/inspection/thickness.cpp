#include "engine/inspection/thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

constexpr int lines_per_span = 3;
constexpr int newton_steps = 12;
// Newton's method counts as converged if the distance from the line is at most this fraction of the distance
// to the exit.
constexpr double newton_tolerance = 1e-9;

double clamp_to_domain(const KnotVector& knots, double parameter) {
  return knots.is_periodic() ? parameter : std::clamp(parameter, knots.domain_start(), knots.domain_end());
}

std::vector<double> subdivide(const std::vector<double>& ends) {
  std::vector<double> all;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for (int p = 0; p < lines_per_span; ++p)
      all.push_back(ends[k] + (ends[k + 1] - ends[k]) * p / lines_per_span);
  }
  all.push_back(ends.back());
  return all;
}

}  // namespace

ThicknessSearch::ThicknessSearch(const Surface& surface)
    : surface_(&surface), cells_(piece_cells(surface, lines_per_span)), exits_(facets()) {
  SPOONBILL_ASSERT(has_matching_net(surface));
}

std::vector<Triangle> ThicknessSearch::facets() {
  const std::vector<double> u = subdivide(surface_->u.breakpoints());
  const std::vector<double> v = subdivide(surface_->v.breakpoints());
  std::vector<Triangle> facets;
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const double u0 = u[i], u1 = u[i + 1], v0 = v[j], v1 = v[j + 1];
      const Vector3 a = position(*surface_, u0, v0), b = position(*surface_, u1, v0);
      const Vector3 c = position(*surface_, u1, v1), d = position(*surface_, u0, v1);
      facets.push_back({a, b, c});
      parameters_.push_back({{u0, u1, u1}, {v0, v0, v1}});
      facets.push_back({a, c, d});
      parameters_.push_back({{u0, u1, u0}, {v0, v1, v1}});
    }
  }
  return facets;
}

std::optional<Thickness> ThicknessSearch::at(double u, double v) const {
  const Vector3 from = position(*surface_, u, v), inward = -unit_normal(*surface_, u, v);
  if (!(inward.squaredNorm() > 0.5)) return std::nullopt;
  const auto out = exit(from, inward);
  if (!out) return std::nullopt;
  return Thickness{out->distance_m, u, v, out->u, out->v, from, from + out->distance_m * inward};
}

std::optional<SurfaceExit> ThicknessSearch::exit(const Vector3& from, const Vector3& direction) const {
  SPOONBILL_ASSERT(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  const auto met = exits_.first(from, direction);
  if (!met || !exits_through_wall(exits_.triangles()[met->triangle], direction)) return std::nullopt;
  return refine_exit(*met, from, direction);
}

// Moves the exit from the facet to the exact surface by Newton's method. Keeps the exit on the facet if the
// method does not converge, as at a pole.
SurfaceExit ThicknessSearch::refine_exit(const LineExit& exit, const Vector3& from,
                                         const Vector3& direction) const {
  const Triangle& facet = exits_.triangles()[exit.triangle];
  const Parameters& at = parameters_[exit.triangle];
  const double b = std::clamp(exit.to_b, 0.0, 1.0), c = std::clamp(exit.to_c, 0.0, 1.0 - b);
  const Eigen::Vector3d start(exit.distance_m, (1.0 - b - c) * at.u[0] + b * at.u[1] + c * at.u[2],
                              (1.0 - b - c) * at.v[0] + b * at.v[1] + c * at.v[2]);
  const auto exit_at = [&](const Eigen::Vector3d& found) {
    return SurfaceExit{found.x(), surface_->u.into_domain(found.y()), surface_->v.into_domain(found.z())};
  };
  Eigen::Vector3d unknown = start;
  const double near = exit.distance_m + (facet[1] - facet[0]).norm() + (facet[2] - facet[0]).norm();
  for (int step = 0; step < newton_steps; ++step) {
    const SurfacePoint point = evaluate(*surface_, unknown.y(), unknown.z());
    const Vector3 miss = point.position_m - from - unknown.x() * direction;
    if (miss.norm() <= newton_tolerance * exit.distance_m && unknown.x() > 0.0 && unknown.x() < near) {
      return exit_at(unknown);
    }
    Eigen::Matrix3d jacobian;
    jacobian << -direction, point.du, point.dv;
    const Eigen::Vector3d move = solve_linear(jacobian, miss);
    if (!move.allFinite()) break;
    unknown -= move;
    unknown.y() = clamp_to_domain(surface_->u, unknown.y());
    unknown.z() = clamp_to_domain(surface_->v, unknown.z());
  }
  return exit_at(start);
}

std::optional<Thickness> ThicknessSearch::smallest(const Progress& progress) const {
  const auto value = [&](double u, double v) {
    const auto thickness = at(u, v);
    return thickness ? thickness->thickness_m : std::numeric_limits<double>::infinity();
  };
  const ParameterMinimum found = find_minimum(cells_, value, progress);
  return std::isfinite(found.value) ? at(found.u, found.v) : std::nullopt;
}

namespace {

constexpr double rounding_m = 1e-8;

}  // namespace

ExactWalls::ExactWalls(const std::vector<const Surface*>& surfaces, double error_m)
    : reach_m_(2.0 * error_m + rounding_m) {
  SPOONBILL_ASSERT(error_m >= 0.0);
  SPOONBILL_ASSERT_DEBUG(
      std::none_of(surfaces.begin(), surfaces.end(), [](const Surface* one) { return one == nullptr; }));
  faces_.reserve(surfaces.size());
  for (const Surface* surface : surfaces) {
    faces_.push_back({surface, bounding_box(surface->net), ThicknessSearch(*surface)});
  }
}

// Returns the exit nearest to `expected`. Considers only surfaces whose control nets have bounding boxes near
// `expected`.
std::optional<ExactWalls::FoundExit> ExactWalls::find_exit_near(const Vector3& from, const Vector3& expected,
                                                                const Vector3& direction) const {
  std::optional<FoundExit> best;
  const double distance_m = (expected - from).norm();
  for (const Face& face : faces_) {
    if (!face.net.is_near({expected, expected}, reach_m_)) continue;
    const auto exit = face.search.exit(from, direction);
    if (!exit) continue;
    const double error_m = std::abs(exit->distance_m - distance_m);
    if (!best || error_m < std::abs(best->exit.distance_m - distance_m))
      best = FoundExit{face.surface, *exit};
  }
  return best;
}

std::optional<WallThickness> ExactWalls::at(const WallThickness& mesh_wall) const {
  if (!(mesh_wall.thickness_m > 0.0)) return std::nullopt;
  const Vector3 centre = 0.5 * (mesh_wall.position_m + mesh_wall.opposite_m);
  const Vector3 outward = (mesh_wall.position_m - mesh_wall.opposite_m).stableNormalized();
  const auto start = find_exit_near(centre, mesh_wall.position_m, outward);
  if (!start) return std::nullopt;
  const Vector3 inward = -unit_normal(*start->surface, start->exit.u, start->exit.v);
  if (!(inward.squaredNorm() > 0.5)) return std::nullopt;
  WallThickness wall;
  wall.position_m = centre + start->exit.distance_m * outward;
  const auto end = find_exit_near(wall.position_m, mesh_wall.opposite_m, inward);
  if (!end) return std::nullopt;
  wall.thickness_m = end->exit.distance_m;
  wall.opposite_m = wall.position_m + wall.thickness_m * inward;
  if (std::abs(wall.thickness_m - mesh_wall.thickness_m) > 2.0 * reach_m_) return std::nullopt;
  return wall;
}

}  // namespace spoonbill
