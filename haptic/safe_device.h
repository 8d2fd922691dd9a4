// The safety chain between the force that the coupling requests and the hand, which no fault of the program
// may injure.
//
// SafeDevice is the only code that sets the force of a device, both live and in lock-step, so no force
// reaches a hand unchecked. make_safe() applies these steps in every tick:
//   1. A fault gives zero force within that tick: a value that is not finite, a stale simulation, a stall, a
//      released dead-man button, a device that does not answer.
//   2. The force stays off until the requested force has been small for some ticks, so that a hand that
//      starts inside the material is not thrown out; then the force ramps in.
//   3. Its norm is limited to the maximum of the device.
//   4. It fades for a hand that is too fast or outside the workspace.
//   5. Its change per tick is limited.
//   6. A requested force that vibrates faster than a hand moves (haptic/vibration.h) is cut. It is judged
//      before the limits, which would hide it.
// After a fault or a cut the chain restarts at step 2. A cut is the one change that may exceed the limit of
// step 5.
//
// The order and the quiet force follow cGenericTool of CHAI3D; the other limits belong to the device. The
// state hash excludes the chain, because it is the coupling (haptic/tick.h) that moves the material.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "haptic/device.h"
#include "haptic/vibration.h"

namespace spoonbill {

// Reasons why the hand does not receive the requested force. safety_text() describes each.
enum SafetyFlag : std::uint32_t {
  safety_flag_none = 0,
  safety_flag_cut = 1u << 0,  // a fault made the force zero in this tick
  // Faults; each stays set until the full force is back.
  safety_flag_not_finite = 1u << 1,
  safety_flag_stale = 1u << 2,
  safety_flag_stalled = 1u << 3,
  safety_flag_buzzing = 1u << 4,
  safety_flag_dead_man = 1u << 5,
  // Conditions of this tick.
  safety_flag_waiting = 1u << 6,
  safety_flag_ramping = 1u << 7,
  safety_flag_force_limited = 1u << 8,
  safety_flag_fast = 1u << 9,
  safety_flag_outside = 1u << 10,
  safety_flag_change_limited = 1u << 11,
  // Another fault, which stays set like the faults above.
  safety_flag_no_device = 1u << 12,
};

struct SafetyInput {
  Vector3 requested_n = Vector3::Zero();  // force requested by the coupling
  Vector3 position_m = Vector3::Zero();   // position of the handle relative to the centre of the workspace
  std::uint32_t buttons = 0;
  std::uint64_t dropped_ticks = 0;  // whole ticks that passed without a call since the last one
  bool stale = false;               // requested_n is not from this tick
  bool no_device = false;           // the device does not answer: position and buttons are not from this tick
};

struct SafeForce {
  Vector3 force_n = Vector3::Zero();
  std::uint32_t flags = safety_flag_none;
  bool reset_proxy = false;  // requests that the proxy be moved to the device before the next tick
};

// State of the chain. Plain data, owned by the ticking thread. Forces are off initially.
struct SafetyState {
  bool engaged = false;
  int quiet_ticks = 0;
  double gain = 0.0;                  // progress of the ramp, 0 to 1
  std::uint32_t cause = 0;            // faults that caused the last restart
  Vector3 force_n = Vector3::Zero();  // force of the last tick
  bool position_known = false;
  Vector3 position_m = Vector3::Zero();
  VibrationState vibration;  // of the requested force since the chain engaged
};

// Applies the chain to one tick. A pure function: it does not allocate, lock, read a clock or throw. The
// specification has passed check_specification(). Called only by SafeDevice.
SafeForce make_safe(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input);

// Returns one line for each flag that concerns the user, the most serious first, separated by newlines. Empty
// if no flag is set.
std::string safety_text(std::uint32_t flags);

// A device behind the safety chain.
//
//   once a tick:  read() -> reset the proxy if consume_proxy_reset() -> advance the simulation -> give(force)
//   or, without a simulation to advance:  read() -> give_none()
//
// A device that does not answer, or answers with an invalid reading, gets no force. Its last valid reading
// replaces the missing one, as a hand that only points: the tool releases the material and touches nothing.
// When the device is back, the proxy is reset to the position of the hand, and the force returns as after any
// other fault.
//
// One owner, the owner of the device. Does not allocate, lock or read a clock.
class SafeDevice {
 public:
  // The device must outlive this object, and its specification must pass check_specification(): all limits
  // come from there. The workspace has the radius of the specification and is centred on the first valid
  // reading. `last` is returned while the device has never answered; it must be valid.
  explicit SafeDevice(Device& device, const DeviceReading& last = {});

  // Moves or resizes the workspace, in scene coordinates.
  void set_workspace_centre(const Vector3& centre_m) { workspace_centre_m_ = centre_m; }
  void set_workspace_radius(double radius_m) { limits_.workspace_radius_m = radius_m; }

  // Returns a valid reading for this tick: that of the device, or a replacement as described above.
  DeviceReading read();

  // Returns whether the proxy must be moved to the device before this tick advances, and clears the request.
  bool consume_proxy_reset();
  // Requests a reset of the proxy, for a simulation that has missed the last motion of the hand.
  void request_proxy_reset() { proxy_is_stale_ = true; }

  // Sends the safe part of the requested force to the hand and returns it. `dropped_ticks` is the number of
  // whole ticks skipped before this one.
  Vector3 give(const Vector3& requested_n, std::uint64_t dropped_ticks);
  // Sends zero force while nothing computes a force.
  void give_none(std::uint64_t dropped_ticks);

  // SafetyFlag bits of the last force sent.
  std::uint32_t flags() const { return flags_; }

 private:
  Vector3 give(SafetyInput input);

  Device* device_;
  DeviceSpecification limits_;  // limits of the device, except for the radius of the workspace
  std::optional<Vector3> workspace_centre_m_;
  DeviceReading reading_;  // last valid reading
  bool answers_ = true;
  bool proxy_is_stale_ = false;
  SafetyState state_;
  std::uint32_t flags_ = safety_flag_none;
};

}  // namespace spoonbill
