#include "haptic/devices/scripted_device.h"

#include <utility>

namespace spoonbill {

Result<ScriptedDevice> ScriptedDevice::make(const Script& script) {
  auto handle = VirtualDevice::make(script.hand, script.start);
  if (!handle) return handle.error();
  return ScriptedDevice(script, std::move(handle).value());
}

std::optional<DeviceReading> ScriptedDevice::read() {
  handle_.set_target(script_->target_at(tick_++));
  return handle_.read();
}

}  // namespace spoonbill
