#include "engine/scene/body_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

Quaternion orientation(const Waypoint& waypoint) {
  return Quaternion(Eigen::AngleAxisd(waypoint.angle_deg * std::numbers::pi / 180.0, waypoint.axis));
}

double angle_between_deg(const Waypoint& first, const Waypoint& second) {
  return orientation(first).angularDistance(orientation(second)) * 180.0 / std::numbers::pi;
}

// Allows for rounding, as of waypoints that were turned with their body.
constexpr double rounding = 1e-9;

Status check_step(const Waypoint& from, const Waypoint& to) {
  const double step_s = to.time_s - from.time_s;
  if (!(step_s > 0.0)) {
    return Error{ErrorCode::inconsistent,
                 "at_s: " + number_text(to.time_s) + " s is not after the waypoint before, at " +
                     number_text(from.time_s) + " s; state waypoints in the order of their times",
                 "at_s"};
  }
  const double turn_deg = angle_between_deg(from, to);
  if (turn_deg > (1.0 + rounding) * waypoint_turn_limit_deg) {
    return Error{ErrorCode::inconsistent,
                 "angle_deg: the body turns by more than " + number_text(waypoint_turn_limit_deg) +
                     " degrees since the waypoint before; add one between them",
                 "angle_deg"};
  }
  const double speed_m_per_s = (to.moved_m - from.moved_m).norm() / step_s;
  if (speed_m_per_s > (1.0 + rounding) * waypoint_speed_limit_m_per_s ||
      turn_deg / step_s > (1.0 + rounding) * waypoint_turn_speed_limit_deg_per_s) {
    return Error{ErrorCode::inconsistent,
                 "at_s: the body is faster than " + number_text(waypoint_speed_limit_m_per_s) + " m/s or " +
                     number_text(waypoint_turn_speed_limit_deg_per_s) +
                     " degrees a second since the waypoint before; state a later time",
                 "at_s"};
  }
  return {};
}

// Returns the rate of a path of vectors at a knot between two steps, from their durations and mean rates: the
// harmonic mean of both lengths in their mean direction. It is zero where the path turns by 90 degrees or
// more.
template <class Vector>
Vector find_rate(double first_s, double second_s, const Vector& first, const Vector& second) {
  if (!(first.dot(second) > 0.0)) return Vector::Zero();
  const double first_weight = 2.0 * second_s + first_s, second_weight = second_s + 2.0 * first_s;
  const double length =
      (first_weight + second_weight) / (first_weight / first.norm() + second_weight / second.norm());
  return length * (first / first.norm() + second / second.norm()).normalized();
}

}  // namespace

Status check_motion(const BodyMotion& motion) {
  const auto count = static_cast<int>(motion.waypoints.size());
  if (Status status = check_range("waypoints", count, waypoint_count_range); !status.ok()) return status;
  if (Status status = check_position("point_mm", motion.point_m); !status.ok()) return status;
  Waypoint from;
  from.time_s = 0.0;
  for (std::size_t w = 0; w < motion.waypoints.size(); ++w) {
    const Waypoint& to = motion.waypoints[w];
    Status status = check_fields("", to);
    if (status.ok()) status = check_step(from, to);
    if (!status.ok()) return status.error().in("waypoints[" + std::to_string(w) + "]");
    from = to;
  }
  return {};
}

MotionPath::MotionPath(const BodyMotion& motion) : point_m_(motion.point_m) {
  SPOONBILL_ASSERT(check_motion(motion).ok());
  Quaternion last = Quaternion::Identity();
  knots_.push_back({0.0, Vector3::Zero(), last.coeffs(), Vector3::Zero(), Vector4::Zero()});
  for (const Waypoint& waypoint : motion.waypoints) {
    Quaternion turned = orientation(waypoint);
    if (turned.dot(last) < 0.0) turned.coeffs() = -turned.coeffs();  // the same orientation, the shorter way
    last = turned;
    knots_.push_back({waypoint.time_s, waypoint.moved_m, turned.coeffs(), Vector3::Zero(), Vector4::Zero()});
  }
  for (std::size_t k = 1; k + 1 < knots_.size(); ++k) {
    const Knot &before = knots_[k - 1], &after = knots_[k + 1];
    Knot& knot = knots_[k];
    const double first_s = knot.time_s - before.time_s, second_s = after.time_s - knot.time_s;
    knot.moved_rate = find_rate<Vector3>(first_s, second_s, (knot.moved_m - before.moved_m) / first_s,
                                         (after.moved_m - knot.moved_m) / second_s);
    knot.turned_rate = find_rate<Vector4>(first_s, second_s, (knot.turned - before.turned) / first_s,
                                          (after.turned - knot.turned) / second_s);
  }
}

Pose MotionPath::at(double time_s, const Pose& start) const {
  SPOONBILL_ASSERT_DEBUG(time_s >= 0.0);
  if (knots_.empty()) return start;
  const double clamped_s = std::min(time_s, duration_s());
  const auto after = std::find_if(knots_.begin() + 1, knots_.end() - 1,
                                  [&](const Knot& knot) { return knot.time_s >= clamped_s; });
  const Knot &from = *(after - 1), &to = *after;
  const double step_s = to.time_s - from.time_s;
  const double t = (clamped_s - from.time_s) / step_s, rest = 1.0 - t;
  const auto between = [&](const auto& start_value, const auto& end_value, const auto& start_rate,
                           const auto& end_rate) {
    return ((1.0 + 2.0 * t) * rest * rest * start_value + (1.0 + 2.0 * rest) * t * t * end_value +
            step_s * t * rest * (rest * start_rate - t * end_rate))
        .eval();
  };
  const Vector3 moved_m = between(from.moved_m, to.moved_m, from.moved_rate, to.moved_rate);
  const Quaternion turned(
      Vector4(between(from.turned, to.turned, from.turned_rate, to.turned_rate).normalized()));
  const Vector3 point_m = start.position_m + start.orientation * point_m_;
  Pose pose;
  pose.orientation = turned * start.orientation;
  pose.position_m = point_m + moved_m + turned * (start.position_m - point_m);
  return pose;
}

}  // namespace spoonbill
