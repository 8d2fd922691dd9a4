// The wrist: the angles between forearm and hand, and the stops at the ends of their ranges.
#pragma once

#include <array>

#include "engine/base/field.h"
#include "engine/base/geometry.h"

namespace spoonbill {

// The three turns of a hand relative to its forearm. In the neutral position, the handle of the spoon
// continues the forearm. A positive deviation is radial: it lifts the front of the spoon. A positive bend
// turns the front to the left seen from above, a positive rotation turns the right side down.
enum class WristTurn { bend, deviation, rotation };
inline constexpr const char* wrist_turn_names[] = {"bend", "deviation", "rotation"};
inline constexpr std::size_t wrist_turn_count = 3;
using WristAngles = std::array<double, wrist_turn_count>;  // rad

// Plain data.
struct WristModel {
  std::array<Range<double>, wrist_turn_count> range_rad;
  // The angle by which the wrist can be forced beyond its range at most. A stop resists more the farther it
  // is pressed.
  double stop_rad = 0.0;
};

inline constexpr Range<double> wrist_range_deg{-90.0, 90.0};
inline constexpr Range<double> wrist_stop_range_deg{0.1, 20.0};

// Orientation of the forearm: its x axis along the forearm towards the hand, its y axis as near to the
// vertical as that allows. A hand on its elbow has a forearm along x; the z axis of a vertical forearm is
// that of the scene.
Eigen::Matrix3d find_forearm(const Vector3& elbow_m, const Vector3& hand_m);

// find_wrist_angles() returns the turns of a hand, whose x axis is along the handle, relative to a forearm;
// bend and rotation are not determined where the deviation is a quarter turn. find_hand() is its inverse.
WristAngles find_wrist_angles(const Eigen::Matrix3d& forearm, const Eigen::Matrix3d& hand);
Eigen::Matrix3d find_hand(const Eigen::Matrix3d& forearm, const WristAngles& angles);

// Returns the angle to which a stop lets a wrist turn that is asked to turn to `angle_rad`: the same within
// the range; beyond it by e, less than e and less than `stop_rad`.
double stopped_angle(double angle_rad, const Range<double>& range_rad, double stop_rad);

}  // namespace spoonbill
