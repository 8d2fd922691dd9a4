// Motion that a document or a command prescribes for a body: where the body is at given times.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Place of a body at a time of its motion, relative to its place at the start.
struct Waypoint {
  double time_s = 1.0;                // since the start of the motion
  Vector3 moved_m = Vector3::Zero();  // displacement of BodyMotion::point_m
  Vector3 axis = Vector3::UnitX();    // unit vector; a positive angle is counter-clockwise seen against it
  double angle_deg = 0.0;
};

// Path through waypoints, in the order of their times. It begins and ends at rest. Plain data.
struct BodyMotion {
  Vector3 point_m = Vector3::Zero();  // point of the undisplaced body about which it turns
  std::vector<Waypoint> waypoints = {};
};

inline constexpr Range<int> waypoint_count_range{1, 1000};
inline constexpr Range<double> waypoint_time_range_s{0.01, 600.0};
inline constexpr double waypoint_distance_limit_m = 1.0;  // from the start
inline constexpr Range<double> waypoint_angle_range_deg{-180.0, 180.0};
// Limits from one waypoint to the next. The turn has a limit because the body turns the shorter way. Speeds
// are means; within a step, a body is up to three times as fast.
inline constexpr double waypoint_turn_limit_deg = 120.0;
inline constexpr double waypoint_speed_limit_m_per_s = 2.0;
inline constexpr double waypoint_turn_speed_limit_deg_per_s = 360.0;

template <>
inline constexpr auto fields_of<Waypoint> = std::to_array<Field<Waypoint>>({
    number_field("at_s", &Waypoint::time_s, waypoint_time_range_s, FieldUnit::second),
    vector_field("moved_mm", &Waypoint::moved_m, waypoint_distance_limit_m, FieldUnit::metre).optional(),
    direction_field("axis", &Waypoint::axis).optional(),
    number_field("angle_deg", &Waypoint::angle_deg, waypoint_angle_range_deg).optional(),
});

// Checks the number of waypoints, their fields, their order and the limits from one to the next. The error
// names the first waypoint at fault.
Status check_motion(const BodyMotion& motion);

// Smooth path of a body through its waypoints: cubics whose rates at the waypoints are harmonic means of
// those of the steps beside them (Fritsch and Butland 1984), so that a body does not overshoot, rests between
// two equal waypoints, and stops where it turns back. Allocates only in its constructor.
class MotionPath {
 public:
  MotionPath() = default;  // stays at the start
  // The motion must pass check_motion().
  explicit MotionPath(const BodyMotion& motion);

  double duration_s() const { return knots_.empty() ? 0.0 : knots_.back().time_s; }
  // Returns the pose that maps the place at the start to that at `time_s`, which must not be negative. A body
  // that has a pose at the start carries the point of the motion with it.
  Pose at(double time_s, const Pose& start) const;

  // Calls visit(const double*, count) with all values of the path.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit(point_m_.data(), 3);
    for (const Knot& knot : knots_) {
      visit(&knot.time_s, 1);
      visit(knot.moved_m.data(), 3);
      visit(knot.turned.data(), 4);
    }
  }

 private:
  using Vector4 = Eigen::Vector4d;
  // Displacement and quaternion (x, y, z, w) at a waypoint or at the start, and their rates of change.
  struct Knot {
    double time_s = 0.0;
    Vector3 moved_m = Vector3::Zero();
    Vector4 turned = Vector4::Zero();
    Vector3 moved_rate = Vector3::Zero();
    Vector4 turned_rate = Vector4::Zero();
  };

  Vector3 point_m_ = Vector3::Zero();
  std::vector<Knot> knots_;
};

}  // namespace spoonbill
