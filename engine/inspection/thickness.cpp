#include "engine/inspection/thickness.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

constexpr int parts = 3;
constexpr int newton_steps = 12;
// Of the way to it: how near to the line Newton's method has to come.
constexpr double exact = 1e-9;

double within(const KnotVector& knots, double parameter) {
  return knots.is_periodic() ? parameter : std::clamp(parameter, knots.domain_start(), knots.domain_end());
}

std::vector<double> cut_evenly(const std::vector<double>& ends) {
  std::vector<double> all;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for (int p = 0; p < parts; ++p) all.push_back(ends[k] + (ends[k + 1] - ends[k]) * p / parts);
  }
  all.push_back(ends.back());
  return all;
}

}  // namespace

ThicknessSearch::ThicknessSearch(const Surface& surface)
    : surface_(&surface), cells_(piece_cells(surface, parts)), exits_(facets()) {
  SPOONBILL_ASSERT(has_matching_net(surface));
}

std::vector<Triangle> ThicknessSearch::facets() {
  const std::vector<double> u = cut_evenly(surface_->u.breakpoints());
  const std::vector<double> v = cut_evenly(surface_->v.breakpoints());
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
  return settled(*met, from, direction);
}

// Newton's method from the facet to the surface itself.
SurfaceExit ThicknessSearch::settled(const LineExit& exit, const Vector3& from,
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
    if (miss.norm() <= exact * exit.distance_m && unknown.x() > 0.0 && unknown.x() < near) {
      return exit_at(unknown);
    }
    Eigen::Matrix3d jacobian;
    jacobian << -direction, point.du, point.dv;
    const Eigen::Vector3d move = Eigen::PartialPivLU<Eigen::Matrix3d>(jacobian).solve(miss);
    if (!move.allFinite()) break;
    unknown -= move;
    unknown.y() = within(surface_->u, unknown.y());
    unknown.z() = within(surface_->v, unknown.z());
  }
  return exit_at(start);  // where that does not come to the line, as at a pole
}

std::optional<Thickness> ThicknessSearch::smallest(const Progress& progress) const {
  const auto value = [&](double u, double v) {
    const auto found = at(u, v);
    return found ? found->thickness_m : std::numeric_limits<double>::infinity();
  };
  const ParameterPlace place = least_place(cells_, value, progress);
  return std::isfinite(place.value) ? at(place.u, place.v) : std::nullopt;
}

}  // namespace spoonbill
