#include "engine/simulation/symmetry.h"

#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

Vector3 mirrored_point(const Symmetry& symmetry, const Vector3& point_m) {
  SPOONBILL_ASSERT_DEBUG(std::abs(symmetry.normal.squaredNorm() - 1.0) < 1e-5);
  return point_m - 2.0 * symmetry.normal.dot(point_m - symmetry.point_m) * symmetry.normal;
}

Pose mirrored_pose(const Symmetry& symmetry, const Pose& pose) {
  SPOONBILL_ASSERT_DEBUG(std::abs(symmetry.normal.squaredNorm() - 1.0) < 1e-5);
  const Vector3 axis = pose.orientation.vec();
  const Vector3 mirrored = 2.0 * symmetry.normal.dot(axis) * symmetry.normal - axis;
  return {mirrored_point(symmetry, pose.position_m),
          Quaternion(pose.orientation.w(), mirrored.x(), mirrored.y(), mirrored.z())};
}

}  // namespace spoonbill
