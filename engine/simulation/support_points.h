// Points on which a rigid body rests, out of many points near a plane: those that touch the plane first when
// the body tilts slightly in some direction, or does not tilt.
#pragma once

#include <array>
#include <cstddef>

#include "engine/base/geometry.h"

namespace spoonbill {

// Used by one thread. Allocates nothing.
class SupportPoints {
 public:
  struct Support {
    Vector3 direction = Vector3::Zero();  // along which the point is the farthest
    int index = -1;                       // of the point; -1 while no point has been offered
    double reach_m = 0.0;                 // of the point along the direction, from the plane
  };

  SupportPoints() = default;
  // The unit vector `normal` points from the plane to the body.
  explicit SupportPoints(const Vector3& normal) {
    const Vector3 first = normal.unitOrthogonal(), second = normal.cross(first);
    supports_[0].direction = -normal;
    for (std::size_t d = 0; d < tilt_directions.size(); ++d) {
      const Vector3 along = tilt_directions[d][0] * first + tilt_directions[d][1] * second;
      for (std::size_t t = 0; t < tilts_rad.size(); ++t)
        supports_[1 + d * tilts_rad.size() + t].direction = -normal + tilts_rad[t] * along;
    }
  }

  Vector3 normal() const { return -supports_[0].direction; }

  // Offers a point at the distance `gap_m` from the plane.
  void offer(int index, const Vector3& point_m, double gap_m) {
    const double height_m = normal().dot(point_m);
    for (Support& support : supports_) {
      const double reach_m = support.direction.dot(point_m) + height_m - gap_m;
      if (support.index >= 0 && !(reach_m > support.reach_m)) continue;
      support.index = index;
      support.reach_m = reach_m;
    }
  }

  // Unit vectors in the plane. None is along rows of samples, where two would be equally far.
  static constexpr std::array<std::array<double, 2>, 8> tilt_directions = {{{0.96, 0.28},
                                                                            {0.28, 0.96},
                                                                            {-0.28, 0.96},
                                                                            {-0.96, 0.28},
                                                                            {-0.96, -0.28},
                                                                            {-0.28, -0.96},
                                                                            {0.28, -0.96},
                                                                            {0.96, -0.28}}};
  // Angles by which the body may tilt before contacts are searched again, rad.
  static constexpr std::array<double, 2> tilts_rad = {1e-3, 3e-2};
  static constexpr std::size_t count = 1 + tilt_directions.size() * tilts_rad.size();

  // Several supports may have the same point.
  const std::array<Support, count>& supports() const { return supports_; }

 private:
  std::array<Support, count> supports_;
};

}  // namespace spoonbill
