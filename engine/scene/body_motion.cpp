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

Status check_step(const Waypoint& from, const Waypoint& to) {
  const double step_s = to.time_s - from.time_s;
  if (!(step_s > 0.0)) {
    return Error{ErrorCode::inconsistent,
                 "at_s: " + number_text(to.time_s) + " s is not after the waypoint before, at " +
                     number_text(from.time_s) + " s; state waypoints in the order of their times",
                 "at_s"};
  }
  const double turn_deg = angle_between_deg(from, to);
  if (turn_deg > waypoint_turn_limit_deg) {
    return Error{ErrorCode::inconsistent,
                 "angle_deg: the body turns by more than " + number_text(waypoint_turn_limit_deg) +
                     " degrees since the waypoint before; add one between them",
                 "angle_deg"};
  }
  const double speed_m_per_s = (to.moved_m - from.moved_m).norm() / step_s;
  if (speed_m_per_s > waypoint_speed_limit_m_per_s ||
      turn_deg / step_s > waypoint_turn_speed_limit_deg_per_s) {
    return Error{ErrorCode::inconsistent,
                 "at_s: the body is faster than " + number_text(waypoint_speed_limit_m_per_s) + " m/s or " +
                     number_text(waypoint_turn_speed_limit_deg_per_s) +
                     " degrees a second since the waypoint before; state a later time",
                 "at_s"};
  }
  return {};
}

// Returns the rate of a monotone cubic at a knot between two steps, from their durations and mean rates.
double monotone_rate(double first_s, double second_s, double first_rate, double second_rate) {
  if (!(first_rate * second_rate > 0.0)) return 0.0;
  const double first_weight = 2.0 * second_s + first_s, second_weight = second_s + 2.0 * first_s;
  return (first_weight + second_weight) / (first_weight / first_rate + second_weight / second_rate);
}

}  // namespace

Status check_motion(const BodyMotion& motion) {
  const auto count = static_cast<int>(motion.waypoints.size());
  if (Status status = check_range("waypoints", count, waypoint_count_range); !status.ok()) return status;
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
  knots_.push_back({0.0, {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}, {}});
  for (const Waypoint& waypoint : motion.waypoints) {
    Quaternion turned = orientation(waypoint);
    if (turned.dot(last) < 0.0) turned.coeffs() = -turned.coeffs();  // the same orientation, the shorter way
    last = turned;
    const Vector3& moved = waypoint.moved_m;
    knots_.push_back({waypoint.time_s,
                      {moved.x(), moved.y(), moved.z(), turned.x(), turned.y(), turned.z(), turned.w()},
                      {}});
  }
  for (std::size_t k = 1; k + 1 < knots_.size(); ++k) {
    const Knot &before = knots_[k - 1], &after = knots_[k + 1];
    Knot& knot = knots_[k];
    const double first_s = knot.time_s - before.time_s, second_s = after.time_s - knot.time_s;
    for (std::size_t i = 0; i < knot.values.size(); ++i) {
      knot.rates[i] = monotone_rate(first_s, second_s, (knot.values[i] - before.values[i]) / first_s,
                                    (after.values[i] - knot.values[i]) / second_s);
    }
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
  Values values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = from.values[i] * (1.0 + 2.0 * t) * rest * rest + to.values[i] * (1.0 + 2.0 * rest) * t * t +
                step_s * t * rest * (from.rates[i] * rest - to.rates[i] * t);
  }
  const Quaternion turned = Quaternion(values[6], values[3], values[4], values[5]).normalized();
  const Vector3 point_m = start.position_m + start.orientation * point_m_;
  Pose pose;
  pose.orientation = turned * start.orientation;
  pose.position_m =
      point_m + Vector3(values[0], values[1], values[2]) + turned * (start.position_m - point_m);
  return pose;
}

}  // namespace spoonbill
