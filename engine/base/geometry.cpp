#include "engine/base/geometry.h"

#include <cmath>
#include <string>

#include "engine/base/text.h"

namespace spoonbill {

Status check_range(std::string_view field, double value, Range<double> range) {
  if (range.contains(value)) return {};
  return Error{ErrorCode::out_of_range,
               std::string(field) + " is " + number_text(value) + ", must be from " + number_text(range.low) +
                   " to " + number_text(range.high),
               std::string(field)};
}

Status check_range(std::string_view field, int value, Range<int> range) {
  if (range.contains(value)) return {};
  return Error{ErrorCode::out_of_range,
               std::string(field) + " is " + std::to_string(value) + ", must be from " +
                   std::to_string(range.low) + " to " + std::to_string(range.high),
               std::string(field)};
}

Status check_position(const std::string& field, const Vector3& position_m) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = field + "[" + std::to_string(axis) + "]";
    if (const Status status = check_range(name, position_m[axis], position_range_m); !status) {
      return Error{ErrorCode::out_of_range, status.error().message, field};
    }
  }
  return {};
}

Status check_unit(const std::string& field, const Vector3& vector) {
  constexpr double tolerance = 1e-6;
  const double length = vector.norm();
  if (std::abs(length - 1.0) <= tolerance) return {};
  return Error{ErrorCode::out_of_range,
               field + " has length " + number_text(length) + ", must be a unit vector", field};
}

bool is_inside(const Vector2& point, std::span<const Vector2> polygon) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vector2 &a = polygon[i], &b = polygon[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

}  // namespace spoonbill
