// Sines and angles from basic arithmetic alone, which give the same bits on every machine. The functions of
// the mathematics library may differ in the last bit from one processor to another, and then states would
// too.
#pragma once

#include <numbers>

#include "engine/base/geometry.h"

namespace spoonbill {

inline constexpr double degree_rad = std::numbers::pi / 180.0;

struct SineCosine {
  double sine = 0.0, cosine = 1.0;
};

// Returns the sine and the cosine of an angle of at most half a turn, to a few roundings.
SineCosine sine_cosine(double angle_rad);
// Returns the angle of a point that is not the origin, as std::atan2() does, to a few roundings.
double angle_of(double y, double x);

// Returns the turn about a unit vector by an angle of at most half a turn.
Quaternion turn_about_axis(const Vector3& axis, double angle_rad);
// Returns the rotation vector of a turn: its axis times its angle, which is at most half a turn.
Vector3 rotation_vector(const Quaternion& turn);
// Returns the turn of a rotation vector that is at most half a turn long.
Quaternion turn_by(const Vector3& rotation_rad);

}  // namespace spoonbill
