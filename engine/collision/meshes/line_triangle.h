// Where a straight line meets a triangle. Pure; any thread.
#pragma once

#include <optional>

#include "engine/base/geometry.h"

namespace spoonbill {

struct LineTriangleMeeting {
  double along = 0.0;             // in lengths of the line's direction, either way
  double to_b = 0.0, to_c = 0.0;  // the place in the triangle, from a on the way to b and to c
  double facing = 0.0;            // below zero where the line goes out through it, along its normal
};

// None beside the triangle by more than `loose` of its sides, or where they are parallel (Moeller and
// Trumbore 1997).
inline std::optional<LineTriangleMeeting> line_meets_triangle(const Vector3& from, const Vector3& direction,
                                                              const Vector3& a, const Vector3& b,
                                                              const Vector3& c, double loose) {
  const Vector3 ab = b - a, ac = c - a, across = direction.cross(ac);
  const double facing = ab.dot(across);
  if (facing == 0.0) return std::nullopt;
  const Vector3 offset = from - a, turned = offset.cross(ab);
  const double to_b = offset.dot(across) / facing, to_c = direction.dot(turned) / facing;
  if (to_b < -loose || to_c < -loose || to_b + to_c > 1.0 + loose) return std::nullopt;
  return LineTriangleMeeting{ac.dot(turned) / facing, to_b, to_c, facing};
}

}  // namespace spoonbill
