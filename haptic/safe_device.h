// The safety chain between the force that the coupling requests and the hand. It keeps faults of the program
// from injuring the hand.
//
// SafeDevice is the only code that sets the force of a device, in a live session and in a replay, so no force
// reaches a hand unchecked. make_safe() applies these steps in every tick:
//   1. A fault gives zero force within that tick: a value that is not finite, a stale simulation, a stall, a
//      loop that misses most of its ticks, a hand that moves impossibly fast, a released dead-man button, a
//      device without a valid reading. A force that the user has switched off counts as a fault.
//   2. The force stays off until the requested force has been small for some ticks, so that a hand that
//      starts inside the material is not thrown out; then the force ramps in.
//   3. The norm of the force is limited to the maximum of the device.
//   4. The force fades if the hand is too fast or outside the workspace.
//   5. The change of the force per tick is limited.
//   6. A requested force that vibrates faster than a hand moves (haptic/vibration.h) is cut. Vibration is
//      detected before the limits of steps 3 to 5, which would hide it.
// After a fault of step 1 or a vibration of step 6, the chain restarts at step 2. Only these two may change
// the force by more than the limit of step 5.
//
// The order of the steps and the limit of a small force follow cGenericTool of CHAI3D; the other limits are
// properties of the device. The state hash excludes the state of the chain, because the coupling
// (haptic/tick.h), not the chain, moves the material.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "haptic/device.h"
#include "haptic/tick_history.h"
#include "haptic/vibration.h"

namespace spoonbill {

// Reasons why the hand does not receive the requested force. safety_text() describes each reason.
enum SafetyFlag : std::uint32_t {
  safety_flag_none = 0,
  safety_flag_cut = 1u << 0,  // a fault made the force zero in this tick
  // Faults. The flag of a fault stays set until the force is back at full strength.
  safety_flag_not_finite = 1u << 1,
  safety_flag_stale = 1u << 2,
  safety_flag_stalled = 1u << 3,
  safety_flag_buzzing = 1u << 4,
  safety_flag_dead_man = 1u << 5,
  // Conditions of the current tick, which are not faults.
  safety_flag_waiting = 1u << 6,
  safety_flag_ramping = 1u << 7,
  safety_flag_force_limited = 1u << 8,
  safety_flag_fast = 1u << 9,
  safety_flag_outside = 1u << 10,
  safety_flag_change_limited = 1u << 11,
  // Further faults. The flag of a fault stays set until the force is back at full strength.
  safety_flag_no_device = 1u << 12,
  safety_flag_jumped = 1u << 13,
  safety_flag_off = 1u << 14,
  safety_flag_slow = 1u << 15,
  // Condition of the current tick: the stiffness of the coupling is reduced (haptic/tick.h).
  safety_flag_softened = 1u << 16,
};

// If two calls of make_safe() are at least this many ticks apart, the gap between them is a stall. In that
// time a hand moves by several millimetres, so the force is no longer valid.
inline constexpr std::uint64_t stall_ticks = 10;

// The force is cut if the tick rate over the last 100 ms is below this value.
inline constexpr double lowest_tick_rate_hz = 200.0;

// A change of position that is faster than this multiple of the device's maximum speed counts as a fault of
// the sensor.
inline constexpr double jump_speed_factor = 5.0;

// Returns true if a hand on the device cannot have moved by `offset_m` in dropped_ticks + 1 ticks.
bool is_jump(const DeviceSpecification& specification, const Vector3& offset_m, std::uint64_t dropped_ticks);

// Returns true if a gap of `dropped_ticks` whole ticks without a call is a stall.
constexpr bool is_stall(std::uint64_t dropped_ticks) {
  return dropped_ticks >= stall_ticks - 1;
}

struct SafetyInput {
  Vector3 requested_n = Vector3::Zero();  // force requested by the coupling
  Vector3 position_m = Vector3::Zero();   // position of the handle relative to the centre of the workspace
  std::uint32_t buttons = 0;
  std::uint64_t dropped_ticks = 0;  // whole ticks that passed without a call since the last call
  bool stale = false;               // requested_n is not from this tick
  bool off = false;                 // the user has switched the force off
  bool no_device = false;           // no valid reading: position and buttons are not from this tick
};

struct SafeForce {
  Vector3 force_n = Vector3::Zero();
  std::uint32_t flags = safety_flag_none;
  bool reset_proxy = false;  // requests that the proxy be moved to the device before the next tick
};

// State of the safety checks between simulation and device. Plain data, owned by the ticking thread. Forces
// are off initially.
struct SafetyState {
  bool engaged = false;
  int quiet_ticks = 0;
  double gain = 0.0;                  // progress of the ramp, 0 to 1
  std::uint32_t cause = 0;            // faults that caused the last restart
  Vector3 force_n = Vector3::Zero();  // force of the last tick
  bool position_known = false;        // true if the last tick had a valid position
  Vector3 position_m = Vector3::Zero();
  VibrationState vibration;  // history of the requested force since the chain engaged
  TickHistory ticks;         // history of the ticks since the last stall
};

// Applies the chain to one tick. Depends only on its arguments, and does not allocate, lock, read a clock or
// throw. The specification must have passed check_specification(). Called only by SafeDevice.
SafeForce make_safe(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input);

// Returns one line for each flag that concerns the user, the most serious flag first, separated by newlines.
// Empty if no flag is set.
std::string safety_text(std::uint32_t flags);

// Wraps a device, so that the force on the hand passes through the safety chain.
//
//   once a tick:  read(dropped ticks) -> reset the proxy if consume_proxy_reset()
//                 -> advance the simulation -> give(force)
//   or, without a simulation to advance:  read(dropped ticks) -> give_none()
//
// A device that does not answer, or answers with an invalid reading, gets no force. Its last valid reading
// replaces the missing reading, with button_hover as its only button: the tool releases the material and
// touches nothing. A reading that reports an impossibly fast motion also gets button_hover as its only
// button. When the fault is over, the proxy is reset to the position of the hand, and the force returns as
// after any other fault. After a stall the proxy is reset in the same tick.
//
// A recording contains the replacement readings and the proxy resets. The readings of a playback device are
// therefore not changed again.
//
// Must have the same owner as the device. Does not allocate, lock or read a clock.
class SafeDevice {
 public:
  // The device must outlive this object. All limits come from the device's specification, which must pass
  // check_specification(). The workspace has the radius of the specification and is centred on the first
  // valid reading. Until the device has answered for the first time, read() returns the pose of `last`, which
  // must be valid.
  explicit SafeDevice(Device& device, const DeviceReading& last = {});
  ~SafeDevice();  // leaves the device without force
  SafeDevice(const SafeDevice&) = delete;
  SafeDevice& operator=(const SafeDevice&) = delete;

  // Moves or resizes the workspace. The centre is in scene coordinates.
  void set_workspace_centre(const Vector3& centre_m) {
    workspace_centre_m_ = centre_m;
    state_.position_known = false;
  }
  void set_workspace_radius(double radius_m) { limits_.workspace_radius_m = radius_m; }

  // Returns a valid reading for this tick: the reading of the device, or a replacement (see the class
  // comment). `dropped_ticks` is the number of whole ticks skipped before this tick.
  DeviceReading read(std::uint64_t dropped_ticks = 0);

  // Returns true if the proxy must be moved to the device before this tick advances, and clears the request.
  bool consume_proxy_reset();
  // Requests a reset of the proxy. To be called after the simulation has missed motions of the hand.
  void request_proxy_reset() { proxy_is_stale_ = true; }

  // Switches the force on or off; default: on. Switching off counts as a fault, so the force ramps in when it
  // is switched on again.
  void switch_force(bool on) { force_on_ = on; }

  // Sends the requested force to the hand, as far as it is safe, and returns the force sent.
  Vector3 give(const Vector3& requested_n);
  // Sends zero force. To be called in ticks in which no force is computed.
  void give_none();

  // SafetyFlag bits of the last force sent.
  std::uint32_t flags() const { return flags_; }

 private:
  Vector3 give(SafetyInput input);
  bool has_jumped(const DeviceReading& reading) const;

  Device* device_;
  DeviceSpecification limits_;  // limits of the device, except for the radius of the workspace
  std::optional<Vector3> workspace_centre_m_;
  DeviceReading reading_;  // last valid reading
  std::uint64_t dropped_ticks_ = 0;
  bool answers_ = true;
  bool position_known_ = false;  // whether the last tick had a valid reading
  bool proxy_is_stale_ = false;
  bool force_on_ = true;
  SafetyState state_;
  std::uint32_t flags_ = safety_flag_none;
};

}  // namespace spoonbill
