#include "app/training/exact_angles.h"

#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr double quarter_turn = 0.5 * std::numbers::pi;

// Returns the angle of a slope from 0 to 1. Halving the angle three times makes the series short.
double arc_tangent(double slope) {
  double halved = slope;
  for (int k = 0; k < 3; ++k) halved /= 1.0 + std::sqrt(1.0 + halved * halved);
  const double square = halved * halved;
  double sum = 0.0;
  for (int power = 19; power >= 1; power -= 2) sum = 1.0 / power - square * sum;
  return 8.0 * halved * sum;
}

}  // namespace

SineCosine sine_cosine(double angle_rad) {
  SPOONBILL_ASSERT(std::abs(angle_rad) <= std::numbers::pi + 1e-9);
  const double half = 0.5 * angle_rad, square = half * half;
  double sine = 1.0, cosine = 1.0;
  for (int n = 10; n >= 1; --n) {
    sine = 1.0 - square / (2 * n * (2 * n + 1)) * sine;
    cosine = 1.0 - square / ((2 * n - 1) * (2 * n)) * cosine;
  }
  sine *= half;
  return {2.0 * sine * cosine, cosine * cosine - sine * sine};
}

double angle_of(double y, double x) {
  SPOONBILL_ASSERT(y != 0.0 || x != 0.0);
  const double rise = std::abs(y), run = std::abs(x);
  double angle = rise <= run ? arc_tangent(rise / run) : quarter_turn - arc_tangent(run / rise);
  if (x < 0.0) angle = std::numbers::pi - angle;
  return y < 0.0 ? -angle : angle;
}

Quaternion turn_about_axis(const Vector3& axis, double angle_rad) {
  const SineCosine half = sine_cosine(0.5 * angle_rad);
  Quaternion turn;
  turn.w() = half.cosine;
  turn.vec() = half.sine * axis;
  return turn;
}

Vector3 rotation_vector(const Quaternion& turn) {
  const double sine = turn.vec().norm();
  if (sine == 0.0) return Vector3::Zero();
  const double half = turn.w() < 0.0 ? angle_of(-sine, -turn.w()) : angle_of(sine, turn.w());
  return (2.0 * half / sine) * turn.vec();
}

Quaternion turn_by(const Vector3& rotation_rad) {
  const double angle = rotation_rad.norm();
  return angle == 0.0 ? Quaternion::Identity() : turn_about_axis(rotation_rad / angle, angle);
}

}  // namespace spoonbill
