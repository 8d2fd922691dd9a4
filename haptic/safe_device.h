// A device behind the safety chain. Live and in lock-step alike this is the only code that reads a device and
// the only code that gives it a force, so that no force reaches a hand past the chain.
//
//   once a tick:  read() -> reset the proxy if take_proxy_reset() -> advance the simulation -> give(force)
//   or, while there is no simulation to advance:                                    read() -> give_none()
//
// A device that does not answer, or answers with garbage, gets no force. Its last good reading stands in for
// it, as a hand that only points: the tool lets go of the material and touches nothing. When the device is
// back, the proxy is reset to where its hand is then, and the force comes back as it does after every fault.
//
// One owner, as the device; allocates nothing, locks nothing, reads no clock.
#pragma once

#include <cstdint>
#include <optional>

#include "haptic/device.h"
#include "haptic/safety.h"

namespace spoonbill {

class SafeDevice {
 public:
  // The device must outlive it; its specification, from which all limits come, has passed
  // check_specification(). The workspace is centred where the hand begins and has the specification's radius.
  // `last` stands in for a device that does not answer from the beginning; it must be valid.
  explicit SafeDevice(Device& device, const DeviceReading& last = {});

  // Moves or resizes the workspace, in the scene.
  void set_workspace_centre(const Vector3& centre_m) { workspace_centre_m_ = centre_m; }
  void set_workspace_radius(double radius_m) { limits_.workspace_radius_m = radius_m; }

  // The reading for this tick, always valid.
  DeviceReading read();

  // Whether the proxy has to be put where the device is before this tick advances; true once for each time.
  bool take_proxy_reset();
  // For a simulation that has not seen the hand's last ticks.
  void request_proxy_reset() { proxy_is_stale_ = true; }

  // Gives the hand what is safe of the force that the coupling wants, and returns that. `dropped_ticks`:
  // whole ticks that passed before this one.
  Vector3 give(const Vector3& wanted_n, std::uint64_t dropped_ticks);
  // No force, while nothing computes one.
  void give_none(std::uint64_t dropped_ticks);

  // SafetyFlag bits of the last force given.
  std::uint32_t flags() const { return flags_; }

 private:
  Vector3 give(SafetyInput input);

  Device* device_;
  DeviceSpecification limits_;  // the device's, but for the radius of the workspace
  std::optional<Vector3> workspace_centre_m_;
  DeviceReading reading_;  // the last good one
  bool answers_ = true;
  bool proxy_is_stale_ = false;
  SafetyState state_;
  std::uint32_t flags_ = safety_flag_none;
};

}  // namespace spoonbill
