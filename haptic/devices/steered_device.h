// The virtual device of a live session: an imitated hand that follows targets from another thread. Mouse,
// SpaceMouse (haptic/devices/hand_inputs.h) and scripts performed live send them through a mailbox.
//
//   main thread --aim()--> [ TargetMailbox ] --> SteeredDevice, on the haptic thread
#pragma once

#include <memory>

#include "engine/base/result.h"
#include "haptic/devices/virtual_device.h"
#include "haptic/hand.h"
#include "haptic/triple_buffer.h"

namespace spoonbill {

// Hands the newest target from one thread to another; neither waits. Targets in between are lost.
class TargetMailbox {
 public:
  explicit TargetMailbox(const HandTarget& start) : targets_(start) {}

  // By one thread, the one that draws.
  void aim(const HandTarget& target) {
    targets_.writing() = target;
    targets_.publish();
  }

  // By the haptic thread: the newest target, null where there is none since the last call. Valid until the
  // next call.
  const HandTarget* take() { return targets_.take() ? &targets_.reading() : nullptr; }

 private:
  TripleBuffer<HandTarget> targets_;
};

// Turns targets that come sixty times a second into one a tick, so that an imitated hand moves evenly.
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

class SteeredDevice : public Device {
 public:
  // At rest at `start`. Refused: what VirtualDevice refuses.
  static Result<std::unique_ptr<SteeredDevice>> make(const Hand& hand, const HandTarget& start);

  // Where targets are sent, also by an owner that outlives the device.
  const std::shared_ptr<TargetMailbox>& mailbox() const { return mailbox_; }

  const DeviceSpecification& specification() const override { return handle_.specification(); }
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override { handle_.set_force(force_n); }

 private:
  SteeredDevice(VirtualDevice handle, const HandTarget& start);

  VirtualDevice handle_;
  std::shared_ptr<TargetMailbox> mailbox_;
  TargetFollower follower_;
};

}  // namespace spoonbill
