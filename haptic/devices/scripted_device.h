// A virtual device whose hand follows a script, tick by tick from 0 on.
#pragma once

#include "haptic/devices/virtual_device.h"
#include "haptic/recording/script.h"

namespace spoonbill {

class ScriptedDevice : public Device {
 public:
  // The script must outlive the device.
  static Result<ScriptedDevice> make(const Script& script);

  const DeviceSpecification& specification() const override { return handle_.specification(); }
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override { handle_.set_force(force_n); }

 private:
  ScriptedDevice(const Script& script, VirtualDevice handle) : script_(&script), handle_(std::move(handle)) {}

  const Script* script_;
  VirtualDevice handle_;
  std::uint64_t tick_ = 0;
};

}  // namespace spoonbill
