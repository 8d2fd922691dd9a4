#include "engine/simulation/rigid_body.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {

void RigidBody::turn(const TurnBody& turn) {
  SPOONBILL_ASSERT(std::abs(turn.axis.squaredNorm() - 1.0) < 1e-5);
  turn_ = turn;
  start_ = pose();
  elapsed_s_ = 0.0;
  turns_ = true;
}

void RigidBody::place(const Pose& pose) {
  motion_ = {pose, pose, false};
  turns_ = false;
}

void RigidBody::begin_tick(double tick_s) {
  SPOONBILL_ASSERT(tick_s > 0.0);
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
