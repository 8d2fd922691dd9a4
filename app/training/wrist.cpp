#include "app/training/wrist.h"

#include <cmath>

#include "app/training/exact_angles.h"

namespace spoonbill {
namespace {

// Returns the direction of a vector; `otherwise` if the vector is too short to have one.
Vector3 direction_or(const Vector3& vector, const Vector3& otherwise) {
  constexpr double shortest = 1e-6;
  const double length = vector.norm();
  return length > shortest ? Vector3(vector / length) : otherwise;
}

double beyond(double excess_rad, double stop_rad) {
  return stop_rad * excess_rad / (excess_rad + stop_rad);
}

}  // namespace

Eigen::Matrix3d find_forearm(const Vector3& elbow_m, const Vector3& hand_m) {
  const Vector3 along = direction_or(hand_m - elbow_m, Vector3::UnitX());
  const Vector3 level = direction_or(along.cross(Vector3::UnitY()), Vector3::UnitZ());
  const Vector3 across = (level - along.dot(level) * along).normalized();
  Eigen::Matrix3d forearm;
  forearm << along, across.cross(along), across;
  return forearm;
}

// With the bend a about y, the deviation b about z and the rotation c about x, in this order, the matrix is
//   cos a cos b   ...                 ...
//   sin b         cos b cos c        -cos b sin c
//  -sin a cos b   ...                 ...
WristAngles find_wrist_angles(const Eigen::Matrix3d& forearm, const Eigen::Matrix3d& hand) {
  const Eigen::Matrix3d turn = forearm.transpose() * hand;
  const double level = std::sqrt(turn(0, 0) * turn(0, 0) + turn(2, 0) * turn(2, 0));
  constexpr double least = 1e-9;
  if (level < least) return {0.0, angle_of(turn(1, 0), level), 0.0};
  return {angle_of(-turn(2, 0), turn(0, 0)), angle_of(turn(1, 0), level), angle_of(-turn(1, 2), turn(1, 1))};
}

Eigen::Matrix3d find_hand(const Eigen::Matrix3d& forearm, const WristAngles& angles) {
  const auto [bend, deviation, rotation] = angles;
  const Quaternion turn = turn_about_axis(Vector3::UnitY(), bend) *
                          turn_about_axis(Vector3::UnitZ(), deviation) *
                          turn_about_axis(Vector3::UnitX(), rotation);
  return forearm * turn.toRotationMatrix();
}

double stopped_angle(double angle_rad, const Range<double>& range_rad, double stop_rad) {
  if (angle_rad > range_rad.high) return range_rad.high + beyond(angle_rad - range_rad.high, stop_rad);
  if (angle_rad < range_rad.low) return range_rad.low - beyond(range_rad.low - angle_rad, stop_rad);
  return angle_rad;
}

}  // namespace spoonbill
