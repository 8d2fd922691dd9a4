#include "tests/engine/trial/exact_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

namespace {

// Number of samples of the body in each direction: 0.3 mm apart on a bowl of 60 mm.
constexpr int body_samples = 400;

}  // namespace

std::size_t ExactDistance::CellHash::operator()(const Cell& cell) const {
  std::size_t hash = 0;
  for (const int index : cell) hash = hash * 1000003u + static_cast<std::size_t>(index + 4096);
  return hash;
}

ExactDistance::Cell ExactDistance::cell_of(const Vector3& point_m) {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis) {
    cell[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(point_m[axis] / reach_m));
  }
  return cell;
}

ExactDistance::ExactDistance(const Surface& surface) : surface_(surface), u_(surface_.u), v_(surface_.v) {
  for (int i = 0; i < body_samples; ++i) {
    for (int j = 0; j < body_samples; ++j) {
      const double u = surface_.u.parameter_at((i + 0.5) / body_samples);
      const double v = surface_.v.parameter_at((j + 0.5) / body_samples);
      const Vector3 point = position(surface_, u, v);
      cells_[cell_of(point)].push_back({point, unit_normal(surface_, u, v), u, v});
    }
  }
}

double ExactDistance::at(const Vector3& point_m) const {
  const Sample* nearest = nullptr;
  double nearest_m = std::numeric_limits<double>::infinity();
  const auto visit_near = [&](const auto& visit) {
    const Cell centre = cell_of(point_m);
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        for (int k = -1; k <= 1; ++k) {
          const auto found = cells_.find({centre[0] + i, centre[1] + j, centre[2] + k});
          if (found == cells_.end()) continue;
          for (const Sample& sample : found->second) visit(sample);
        }
      }
    }
  };
  visit_near([&](const Sample& sample) {
    const double distance_m = (sample.point_m - point_m).norm();
    if (distance_m < nearest_m) nearest_m = distance_m, nearest = &sample;
  });
  if (nearest == nullptr) return reach_m;
  const Sample* opposite = nullptr;
  double opposite_m = std::numeric_limits<double>::infinity();
  visit_near([&](const Sample& sample) {
    if (sample.normal.dot(nearest->normal) > 0.0) return;
    const double distance_m = (sample.point_m - point_m).norm();
    if (distance_m < opposite_m) opposite_m = distance_m, opposite = &sample;
  });
  const PiecewiseSurface pieces{&surface_, &u_, &v_};
  double signed_m = std::numeric_limits<double>::infinity();
  for (const Sample* from : {nearest, opposite}) {
    if (from == nullptr) continue;
    const NearestPoint found = nearest_point(pieces, point_m, from->u, from->v);
    const Vector3 offset = point_m - found.at.position_m;
    const double distance_m = offset.norm();
    if (distance_m >= std::abs(signed_m)) continue;
    const bool is_inside = offset.dot(unit_normal(pieces, found.at, found.u, found.v)) < 0.0;
    signed_m = is_inside ? -distance_m : distance_m;
  }
  return std::min(signed_m, reach_m);
}

std::vector<SkinPoint> sample_skin_points(const Surface& surface, int samples_each_way) {
  std::vector<SkinPoint> points;
  points.reserve(static_cast<std::size_t>(samples_each_way) * static_cast<std::size_t>(samples_each_way));
  for (int i = 0; i < samples_each_way; ++i) {
    for (int j = 0; j < samples_each_way; ++j) {
      const SurfacePoint at = evaluate(surface, surface.u.parameter_at((i + 0.5) / samples_each_way),
                                       surface.v.parameter_at((j + 0.5) / samples_each_way));
      const Vector3 area = at.du.cross(at.dv);
      points.push_back({at.position_m, area.stableNormalized(), area.norm()});
    }
  }
  return points;
}

double find_depth_m(const ExactDistance& body, const std::vector<SkinPoint>& skin) {
  double depth_m = 0.0;
  for (const SkinPoint& point : skin) depth_m = std::max(depth_m, -body.at(point.point_m));
  return depth_m;
}

double find_gap_along_m(const ExactDistance& body, const std::vector<SkinPoint>& skin, const Vector3& down) {
  // The skin advances by its distance from the body, which it cannot pass therefore.
  constexpr double touching_m = 1e-7, farthest_m = 0.1;
  double moved_m = 0.0, nearest_m = ExactDistance::reach_m;
  while (nearest_m > touching_m && moved_m < farthest_m) {
    nearest_m = ExactDistance::reach_m;
    for (const SkinPoint& point : skin) {
      nearest_m = std::min(nearest_m, body.at(point.point_m + moved_m * down));
    }
    moved_m += std::max(nearest_m, 0.0);
  }
  return moved_m;
}

}  // namespace spoonbill
