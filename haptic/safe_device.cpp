#include "haptic/safe_device.h"

#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

SafeDevice::SafeDevice(Device& device, const DeviceReading& last)
    : device_(&device), limits_(device.specification()), reading_(last) {
  SPOONBILL_ASSERT(check_specification(limits_).ok());
  SPOONBILL_ASSERT(last.is_valid());
}

DeviceReading SafeDevice::read() {
  const std::optional<DeviceReading> reading = device_->read();
  const bool answered = std::exchange(answers_, reading.has_value() && reading->is_valid());
  if (!answers_) {
    reading_.buttons = button_hover;
    return reading_;
  }
  if (!answered) proxy_is_stale_ = true;
  reading_ = *reading;
  if (!workspace_centre_m_) workspace_centre_m_ = reading_.pose().position_m;
  return reading_;
}

bool SafeDevice::take_proxy_reset() {
  return std::exchange(proxy_is_stale_, false);
}

Vector3 SafeDevice::give(const Vector3& wanted_n, std::uint64_t dropped_ticks) {
  SafetyInput input;
  input.wanted_n = wanted_n;
  input.dropped_ticks = dropped_ticks;
  return give(input);
}

void SafeDevice::give_none(std::uint64_t dropped_ticks) {
  SafetyInput input;
  input.dropped_ticks = dropped_ticks;
  input.stale = true;
  give(input);
}

Vector3 SafeDevice::give(SafetyInput input) {
  input.position_m = reading_.pose().position_m;
  if (workspace_centre_m_) input.position_m -= *workspace_centre_m_;
  input.buttons = reading_.buttons;
  input.no_device = !answers_;
  const SafeForce safe = make_safe(state_, limits_, input);
  flags_ = safe.flags;
  proxy_is_stale_ = proxy_is_stale_ || safe.reset_proxy;
  device_->set_force(safe.force_n);
  return safe.force_n;
}

}  // namespace spoonbill
