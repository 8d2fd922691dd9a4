// Where a rigid thing is: a position in metres and a unit orientation, in the world frame (x right, y up,
// z toward the person, right-handed: OpenGL's frame).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spoonbill {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

struct Pose {
  Vector3 position_m = Vector3::Zero();
  Quaternion orientation = Quaternion::Identity();
};

}  // namespace spoonbill
