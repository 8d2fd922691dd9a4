#include "engine/simulation/rigid_body.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Returns the pose of a body `time_s` after the start of a turn.
Pose turned_pose(const TurnBody& turn, double time_s, const Pose& start) {
  const double angle = turned_angle_deg(turn, time_s) * std::numbers::pi / 180.0;
  const Quaternion turned(Eigen::AngleAxisd(angle, turn.axis));
  return {turn.point_m + turned * (start.position_m - turn.point_m), turned * start.orientation};
}

}  // namespace

Pose find_pose_between(const Pose& from, const Pose& to, double fraction) {
  const double sign = from.orientation.dot(to.orientation) < 0.0 ? -1.0 : 1.0;
  Pose pose;
  pose.position_m = from.position_m + fraction * (to.position_m - from.position_m);
  pose.orientation.coeffs() =
      (1.0 - fraction) * from.orientation.coeffs() + fraction * sign * to.orientation.coeffs();
  pose.orientation.normalize();
  return pose;
}

void RigidBody::start(std::variant<TurnBody, MotionPath> drive) {
  drive_ = std::move(drive);
  start_ = motion_.end;
  elapsed_s_ = 0.0;
  is_driven_ = true;
  is_carried_ = false;
}

void RigidBody::turn(const TurnBody& turn) {
  SPOONBILL_ASSERT(std::abs(turn.axis.squaredNorm() - 1.0) < 1e-5);
  start(turn);
}

void RigidBody::move(const BodyMotion& motion) {
  start(MotionPath(motion));
}

void RigidBody::carry(const Pose& to, double time_s) {
  SPOONBILL_ASSERT(time_s > 0.0 && to.position_m.allFinite());
  start_ = motion_.end;
  carried_to_ = to;
  carried_s_ = time_s;
  elapsed_s_ = 0.0;
  is_driven_ = is_carried_ = true;
}

void RigidBody::place(const Pose& pose) {
  place_hand(pose);
  if (dynamics_) dynamics_->place(pose);
}

void RigidBody::keep_shape(const LatticeMesh& frame) {
  Pose hand;
  if (hand_) {
    // The hand stays where it is, but its pose now maps the new rest shape.
    hand.orientation = motion_.end.orientation * pose().orientation.conjugate();
    hand.position_m = motion_.end.position_m - hand.orientation * pose().position_m;
  }
  if (dynamics_) dynamics_->keep_shape(frame);
  place_hand(hand);
}

void RigidBody::place_hand(const Pose& pose) {
  motion_ = {pose, pose, false};
  is_driven_ = is_carried_ = false;
}

bool RigidBody::is_finite() const {
  if (!dynamics_) return true;
  return pose().position_m.allFinite() && pose().orientation.coeffs().allFinite() &&
         dynamics_->velocity_m_per_s().allFinite() && dynamics_->spin_rad_per_s().allFinite();
}

void RigidBody::begin_step(double time_s) {
  SPOONBILL_ASSERT(time_s > 0.0);
  step_start_ = pose();
  motion_.start = motion_.end;
  motion_.moves = is_driven_;
  if (!is_driven_) return;
  elapsed_s_ += time_s;
  find_step_end();
}

void RigidBody::shorten_step(double from_s, double to_s) {
  SPOONBILL_ASSERT(to_s > 0.0 && to_s <= from_s);
  if (!motion_.moves) return;
  elapsed_s_ += to_s - from_s;
  find_step_end();
}

void RigidBody::find_step_end() {
  double duration_s = 0.0;
  if (is_carried_) {
    // The parts of a tick add up to a tick but for rounding.
    constexpr double rounding = 1e-9;
    const double fraction = elapsed_s_ / carried_s_;
    is_driven_ = fraction < 1.0 - rounding;
    motion_.end = is_driven_ ? find_pose_between(start_, carried_to_, fraction) : carried_to_;
    return;
  }
  if (const auto* const turn = std::get_if<TurnBody>(&drive_)) {
    motion_.end = turned_pose(*turn, elapsed_s_, start_);
    duration_s = turn_duration_s(*turn);
  } else {
    const MotionPath& path = std::get<MotionPath>(drive_);
    motion_.end = path.at(elapsed_s_, start_);
    duration_s = path.duration_s();
  }
  is_driven_ = elapsed_s_ < duration_s;
}

}  // namespace spoonbill
