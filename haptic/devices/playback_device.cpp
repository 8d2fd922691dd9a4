#include "haptic/devices/playback_device.h"

#include <utility>

namespace spoonbill {

PlaybackDevice::PlaybackDevice(DeviceSpecification specification, std::span<const DeviceReading> readings)
    : specification_(std::move(specification)), readings_(readings) {}

std::optional<DeviceReading> PlaybackDevice::read() {
  if (readings_.empty()) return DeviceReading{};
  if (finished()) return readings_.back();
  return readings_[next_++];
}

void PlaybackDevice::set_force(const Vector3&) {}

}  // namespace spoonbill
