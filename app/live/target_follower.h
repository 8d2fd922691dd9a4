// Turns targets that come sixty times a second into one a tick, so that an imitated hand moves evenly. One
// owner: the haptic thread.
#pragma once

#include "haptic/devices/virtual_device.h"

namespace spoonbill {

class TargetFollower {
 public:
  // A new target is reached after this many ticks, about a frame.
  static constexpr int ticks_to_reach = 17;

  explicit TargetFollower(const HandTarget& start) : now_(start), wanted_(start) {}

  // From here on, on the way to `wanted`. What is not finite is not followed.
  void aim(const HandTarget& wanted);

  // The target of the next tick.
  HandTarget step();

 private:
  HandTarget now_;
  HandTarget wanted_;
  int ticks_left_ = 0;
};

}  // namespace spoonbill
