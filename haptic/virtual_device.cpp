#include "haptic/virtual_device.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/simulation/simulation.h"

namespace spoonbill {

Result<VirtualDevice> VirtualDevice::make(const Hand& hand, const HandTarget& start) {
  if (Status status = check_hand(hand); !status.ok()) return status.error().in("hand");
  if (!is_finite(start)) {
    return Error{ErrorCode::out_of_range, "hand: the start pose is not finite", "start"};
  }
  return VirtualDevice(hand, start);
}

VirtualDevice::VirtualDevice(const Hand& hand, const HandTarget& start)
    : hand_(hand),
      specification_(default_specification()),
      target_(start),
      previous_target_m_(start.pose.position_m),
      position_m_(start.pose.position_m) {}

DeviceSpecification VirtualDevice::default_specification() {
  DeviceSpecification specification;
  specification.name = "virtual";
  specification.workspace_follows_model = true;
  return specification;
}

void VirtualDevice::set_target(const HandTarget& target) {
  target_ = target;
}

std::optional<DeviceReading> VirtualDevice::read() {
  const Vector3& target_m = target_.pose.position_m;
  const Vector3 target_velocity = (target_m - previous_target_m_) / tick_s;
  previous_target_m_ = target_m;
  const Vector3 pull_n = hand_.stiffness_n_per_m * (target_m - position_m_) +
                         hand_.damping_n_s_per_m * target_velocity + force_n_;
  velocity_m_per_s_ = (velocity_m_per_s_ + pull_n * (tick_s / hand_.mass_kg)) /
                      (1.0 + tick_s * hand_.damping_n_s_per_m / hand_.mass_kg);
  position_m_ += velocity_m_per_s_ * tick_s;
  return DeviceReading::from({position_m_, target_.pose.orientation}, target_.buttons);
}

void VirtualDevice::set_force(const Vector3& force_n) {
  const double size = force_n.norm();
  if (!std::isfinite(size)) {
    force_n_.setZero();
    return;
  }
  const double limit = specification_.maximum_force_n;
  force_n_ = size > limit ? Vector3(force_n * (limit / size)) : force_n;
}

Status check_hand(const Hand& hand) {
  if (Status status = check_range("mass_kg", hand.mass_kg, hand_mass_range_kg); !status.ok()) return status;
  if (Status status = check_range("stiffness_n_per_m", hand.stiffness_n_per_m, hand_stiffness_range_n_per_m);
      !status.ok()) {
    return status;
  }
  return check_range("damping_n_s_per_m", hand.damping_n_s_per_m, hand_damping_range_n_s_per_m);
}

bool is_finite(const HandTarget& target) {
  return target.pose.position_m.allFinite() && target.pose.orientation.coeffs().allFinite();
}

PlaybackDevice::PlaybackDevice(DeviceSpecification specification, std::span<const DeviceReading> readings)
    : specification_(std::move(specification)), readings_(readings) {}

std::optional<DeviceReading> PlaybackDevice::read() {
  if (readings_.empty()) return DeviceReading{};
  if (finished()) return readings_.back();
  return readings_[next_++];
}

void PlaybackDevice::set_force(const Vector3&) {}

void TargetFollower::aim(const HandTarget& target) {
  if (!is_finite(target)) return;
  final_ = target;
  ticks_left_ = std::max(ticks_since_target_, ticks_to_reach.low);
  ticks_since_target_ = 0;
}

HandTarget TargetFollower::step() {
  current_.buttons = final_.buttons;
  ticks_since_target_ = std::min(ticks_since_target_ + 1, ticks_to_reach.high);
  if (ticks_left_ == 0) return current_;
  const double fraction = 1.0 / ticks_left_--;
  current_.pose.position_m += fraction * (final_.pose.position_m - current_.pose.position_m);
  current_.pose.orientation = current_.pose.orientation.slerp(fraction, final_.pose.orientation);
  return current_;
}

Result<std::unique_ptr<SteeredDevice>> SteeredDevice::make(const Hand& hand, const HandTarget& start) {
  auto handle = VirtualDevice::make(hand, start);
  if (!handle) return handle.error();
  return std::unique_ptr<SteeredDevice>(new SteeredDevice(std::move(handle).value(), start));
}

SteeredDevice::SteeredDevice(VirtualDevice handle, const HandTarget& start)
    : handle_(std::move(handle)), mailbox_(std::make_shared<TargetMailbox>(start)), follower_(start) {}

std::optional<DeviceReading> SteeredDevice::read() {
  if (const HandTarget* target = mailbox_->receive()) follower_.aim(*target);
  handle_.set_target(follower_.step());
  return handle_.read();
}

}  // namespace spoonbill
