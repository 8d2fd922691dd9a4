#include "haptic/devices/steered_device.h"

#include <utility>

namespace spoonbill {

void TargetFollower::aim(const HandTarget& wanted) {
  if (!is_finite(wanted)) return;
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

Result<std::unique_ptr<SteeredDevice>> SteeredDevice::make(const Hand& hand, const HandTarget& start) {
  auto handle = VirtualDevice::make(hand, start);
  if (!handle) return handle.error();
  return std::unique_ptr<SteeredDevice>(new SteeredDevice(std::move(handle).value(), start));
}

SteeredDevice::SteeredDevice(VirtualDevice handle, const HandTarget& start)
    : handle_(std::move(handle)), mailbox_(std::make_shared<TargetMailbox>(start)), follower_(start) {}

std::optional<DeviceReading> SteeredDevice::read() {
  if (const HandTarget* wanted = mailbox_->take()) follower_.aim(*wanted);
  handle_.set_target(follower_.step());
  return handle_.read();
}

}  // namespace spoonbill
