#include "haptic/devices/virtual_device.h"

#include <cmath>
#include <utility>

#include "engine/simulation/simulation.h"

namespace spoonbill {

Result<VirtualDevice> VirtualDevice::make(const Hand& hand, const HandTarget& start) {
  if (Status status = check_hand(hand); !status.ok()) return Error{"hand: " + status.error().message};
  if (!is_finite(start)) return Error{"hand: the start is not finite"};
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

}  // namespace spoonbill
