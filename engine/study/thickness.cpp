#include "engine/study/thickness.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/collision/meshes/line_triangle.h"

namespace spoonbill {

namespace {

constexpr int parts = 3;
constexpr std::uint32_t leaf_size = 4;
constexpr int newton_steps = 12;
// Of the way to it: how near to the line Newton's method has to come.
constexpr double exact = 1e-9;

Box box_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

// By the slabs between its faces (Kay and Kajiya 1986).
bool meets(const Box& box, const Vector3& from, const Vector3& direction, double farthest) {
  double near = 0.0, far = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (from[axis] < box.low[axis] || from[axis] > box.high[axis]) return false;
      continue;
    }
    double enter = (box.low[axis] - from[axis]) / direction[axis];
    double leave = (box.high[axis] - from[axis]) / direction[axis];
    if (enter > leave) std::swap(enter, leave);
    near = std::max(near, enter);
    far = std::min(far, leave);
  }
  return near <= far;
}

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
    : surface_(&surface), cells_(piece_cells(surface, parts)) {
  const std::vector<double> u = cut_evenly(surface.u.breakpoints()), v = cut_evenly(surface.v.breakpoints());
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) add_facets({u[i], u[i + 1], v[j], v[j + 1]});
  }
  std::vector<Box> boxes;
  for (const Facet& facet : facets_) boxes.push_back(box_of(facet.a, facet.b, facet.c));
  tree_ = std::make_unique<BoxTree>(boxes, leaf_size);
}

void ThicknessSearch::add_facets(const PieceCell& cell) {
  const Vector3 a = position(*surface_, cell.u0, cell.v0), b = position(*surface_, cell.u1, cell.v0);
  const Vector3 c = position(*surface_, cell.u1, cell.v1), d = position(*surface_, cell.u0, cell.v1);
  facets_.push_back({a, b, c, {cell.u0, cell.u1, cell.u1}, {cell.v0, cell.v0, cell.v1}});
  facets_.push_back({a, c, d, {cell.u0, cell.u1, cell.u0}, {cell.v0, cell.v1, cell.v1}});
}

// Through facets that face the same way as the line.
std::optional<ThicknessSearch::Hit> ThicknessSearch::first_exit(const Vector3& from,
                                                                const Vector3& direction) const {
  std::optional<Hit> first;
  const auto farthest = [&] { return first ? first->distance : std::numeric_limits<double>::infinity(); };
  const auto descend = [&](std::uint32_t index) {
    return meets(tree_->nodes()[index].box, from, direction, farthest());
  };
  const auto look_at = [&](std::uint32_t place) {
    const Facet& facet = facets_[place];
    constexpr double loose = 1e-6;  // so that a line along an edge meets one of its facets
    const auto met = line_meets_triangle(from, direction, facet.a, facet.b, facet.c, loose);
    if (!met || !(met->facing < 0.0) || !(met->along > 0.0) || !(met->along < farthest())) return;
    first = Hit{met->along, place, met->to_b, met->to_c};
  };
  tree_->search(
      descend, [](std::uint32_t, std::uint32_t) { return false; },
      [&](std::uint32_t start, std::uint32_t count) {
        for (std::uint32_t k = 0; k < count; ++k) look_at(tree_->order()[start + k]);
      });
  return first;
}

std::optional<Thickness> ThicknessSearch::at(double u, double v) const {
  const Vector3 from = position(*surface_, u, v), inward = -unit_normal(*surface_, u, v);
  if (!(inward.squaredNorm() > 0.5)) return std::nullopt;
  const auto hit = first_exit(from, inward);
  if (!hit) return std::nullopt;
  return settled(*hit, {0.0, u, v, 0.0, 0.0, from, from}, inward);
}

// Newton's method from the facet to the surface itself.
Thickness ThicknessSearch::settled(const Hit& hit, Thickness thickness, const Vector3& inward) const {
  const Facet& facet = facets_[hit.facet];
  const double b = std::clamp(hit.weight_b, 0.0, 1.0), c = std::clamp(hit.weight_c, 0.0, 1.0 - b);
  const Eigen::Vector3d start(hit.distance, (1.0 - b - c) * facet.u[0] + b * facet.u[1] + c * facet.u[2],
                              (1.0 - b - c) * facet.v[0] + b * facet.v[1] + c * facet.v[2]);
  const auto take = [&](const Eigen::Vector3d& found) {
    thickness.thickness_m = found.x();
    thickness.opposite_u = surface_->u.into_domain(found.y());
    thickness.opposite_v = surface_->v.into_domain(found.z());
    thickness.opposite_m = thickness.position_m + found.x() * inward;
    return thickness;
  };
  Eigen::Vector3d unknown = start;
  const double near = hit.distance + (facet.b - facet.a).norm() + (facet.c - facet.a).norm();
  for (int step = 0; step < newton_steps; ++step) {
    const SurfacePoint point = evaluate(*surface_, unknown.y(), unknown.z());
    const Vector3 miss = point.position_m - thickness.position_m - unknown.x() * inward;
    if (miss.norm() <= exact * hit.distance && unknown.x() > 0.0 && unknown.x() < near) return take(unknown);
    Eigen::Matrix3d jacobian;
    jacobian << -inward, point.du, point.dv;
    const Eigen::Vector3d move = Eigen::PartialPivLU<Eigen::Matrix3d>(jacobian).solve(miss);
    if (!move.allFinite()) break;
    unknown -= move;
    unknown.y() = within(surface_->u, unknown.y());
    unknown.z() = within(surface_->v, unknown.z());
  }
  return take(start);  // where that does not come to the line, as at a pole
}

std::optional<Thickness> ThicknessSearch::smallest(const StudyWatch& watch) const {
  const auto value = [&](double u, double v) {
    const auto found = at(u, v);
    return found ? found->thickness_m : std::numeric_limits<double>::infinity();
  };
  const ParameterPlace place = least_place(cells_, value, watch);
  return std::isfinite(place.value) ? at(place.u, place.v) : std::nullopt;
}

}  // namespace spoonbill
