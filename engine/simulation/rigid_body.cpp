#include "engine/simulation/rigid_body.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {

void RigidBody::turn(const TurnBody& turn) {
  SPOONBILL_ASSERT(std::abs(turn.axis.squaredNorm() - 1.0) < 1e-5);
  turn_ = turn;
  start_ = motion_.end;
  elapsed_s_ = 0.0;
  turns_ = true;
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
  turns_ = false;
}

bool RigidBody::is_finite() const {
  if (!dynamics_) return true;
  return pose().position_m.allFinite() && pose().orientation.coeffs().allFinite() &&
         dynamics_->velocity_m_per_s().allFinite() && dynamics_->spin_rad_per_s().allFinite();
}

void RigidBody::begin_tick(double tick_s) {
  SPOONBILL_ASSERT(tick_s > 0.0);
  tick_start_ = pose();
  motion_.start = motion_.end;
  motion_.moves = turns_;
  if (!turns_) return;
  elapsed_s_ += tick_s;
  const double angle = turned_angle_deg(turn_, elapsed_s_) * std::numbers::pi / 180.0;
  const Quaternion turned(Eigen::AngleAxisd(angle, turn_.axis));
  motion_.end.orientation = turned * start_.orientation;
  motion_.end.position_m = turn_.point_m + turned * (start_.position_m - turn_.point_m);
  turns_ = elapsed_s_ < turn_duration_s(turn_);
}

}  // namespace spoonbill
