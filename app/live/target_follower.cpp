#include "app/live/target_follower.h"

namespace spoonbill {

void TargetFollower::aim(const HandTarget& wanted) {
  if (!wanted.pose.position_m.allFinite() || !wanted.pose.orientation.coeffs().allFinite()) return;
  wanted_ = wanted;
  ticks_left_ = ticks_to_reach;
}

HandTarget TargetFollower::step() {
  now_.buttons = wanted_.buttons;
  if (ticks_left_ == 0) return now_;
  const double share = 1.0 / ticks_left_--;
  now_.pose.position_m += share * (wanted_.pose.position_m - now_.pose.position_m);
  now_.pose.orientation = now_.pose.orientation.slerp(share, wanted_.pose.orientation);
  return now_;
}

}  // namespace spoonbill
