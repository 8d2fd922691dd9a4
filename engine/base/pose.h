// Where a rigid thing is: a position in metres and a unit orientation, in the world frame (x right, y up,
// z toward the person, right-handed: OpenGL's frame).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

#include "engine/base/range.h"
#include "engine/base/result.h"

namespace spoonbill {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

struct Pose {
  Vector3 position_m = Vector3::Zero();
  Quaternion orientation = Quaternion::Identity();
};

// What files, commands and the panel accept, each coordinate.
inline constexpr Range<double> position_range_m{-100.0, 100.0};

// Each check names the field, the value and the range.
Status check_position(const std::string& field, const Vector3& position_m);
// Accepts a length of 1 within 1e-6: normals arrive as decimals and from arithmetic.
Status check_unit(const std::string& field, const Vector3& vector);

}  // namespace spoonbill
