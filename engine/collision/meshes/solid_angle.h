// How much of the view a triangle takes up.
#pragma once

#include <cmath>

#include "engine/base/geometry.h"

namespace spoonbill {

inline constexpr double full_solid_angle = 4.0 * 3.14159265358979323846;

// Of the triangle with corners a, b, c, seen from the origin, in steradians: positive where its back is seen,
// so that a closed mesh that faces outward fills the view from inside. 0 from a point in its plane (van
// Oosterom and Strackee 1983).
inline double solid_angle(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return numerator == 0.0 ? 0.0 : 2.0 * std::atan2(numerator, denominator);
}

}  // namespace spoonbill
