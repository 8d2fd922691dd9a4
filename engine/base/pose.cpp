#include "engine/base/pose.h"

#include <cmath>

#include "engine/base/number_text.h"

namespace spoonbill {

Status check_position(const std::string& field, const Vector3& position_m) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = field + "[" + std::to_string(axis) + "]";
    if (Status status = check_range(name, position_m[axis], position_range_m); !status.ok()) return status;
  }
  return {};
}

Status check_unit(const std::string& field, const Vector3& vector) {
  constexpr double tolerance = 1e-6;
  const double length = vector.norm();
  if (std::abs(length - 1.0) <= tolerance) return {};
  return Error{field + " has length " + number_text(length) + ", must be a unit vector"};
}

}  // namespace spoonbill
