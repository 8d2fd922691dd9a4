// What stands between the force that the coupling wants and the hand: no fault of the program may hurt it.
//
// In this order, every tick:
//   1. A fault gives zero force within that tick: a value that is not finite, a stale simulation, a stall, a
//      dead-man button let go, a device that does not answer.
//   2. The force is off until what is wanted has stayed small for some ticks, so that a hand that is inside
//      the material at the start is not thrown out; then it ramps in.
//   3. Its norm is limited to the device's maximum.
//   4. It fades for a hand that is too fast or outside the workspace.
//   5. Its change a tick is limited.
//   6. A force that swings to and fro with energy, faster than a hand moves, is cut.
// After a fault or a cut all begins again at 2. Limiting the change and cutting at once contradict each
// other: the cut to zero is the one step that may be larger.
//
// The order and the quiet force are those that CHAI3D's cGenericTool uses; the other limits are the
// device's own. The state hash has no part in this: what the material feels is the coupling (haptic/tick.h).
#pragma once

#include <cstdint>
#include <string>

#include "haptic/device.h"

namespace spoonbill {

// Why the hand does not feel what the coupling wants. safety_text() has words for each.
enum SafetyFlag : std::uint32_t {
  safety_flag_none = 0,
  safety_flag_cut = 1u << 0,  // in this tick a fault made the force zero
  // The faults; each stays until the whole force is back.
  safety_flag_not_finite = 1u << 1,
  safety_flag_stale = 1u << 2,
  safety_flag_stalled = 1u << 3,
  safety_flag_buzzing = 1u << 4,
  safety_flag_dead_man = 1u << 5,
  // In this tick.
  safety_flag_waiting = 1u << 6,
  safety_flag_ramping = 1u << 7,
  safety_flag_force_limited = 1u << 8,
  safety_flag_fast = 1u << 9,
  safety_flag_outside = 1u << 10,
  safety_flag_change_limited = 1u << 11,
  // A fault, as those above.
  safety_flag_no_device = 1u << 12,
};

struct SafetyInput {
  Vector3 wanted_n = Vector3::Zero();    // what the coupling wants
  Vector3 position_m = Vector3::Zero();  // of the handle, from the middle of the workspace
  std::uint32_t buttons = 0;
  std::uint64_t dropped_ticks = 0;  // whole ticks that passed since the last call without one
  bool stale = false;               // wanted_n is not of this tick
  bool no_device = false;           // position and buttons are not of this tick: the device does not answer
};

struct SafeForce {
  Vector3 force_n = Vector3::Zero();
  std::uint32_t flags = safety_flag_none;
  bool reset_proxy = false;  // put the proxy where the device is, before the next tick
};

// Plain data; one owner, the thread that ticks. As it is made, forces are off.
struct SafetyState {
  bool engaged = false;
  int quiet_ticks = 0;
  double gain = 0.0;                  // 0 to 1: how far the force has come in
  std::uint32_t cause = 0;            // the faults that made it begin again
  Vector3 force_n = Vector3::Zero();  // given in the last tick
  bool position_known = false;
  Vector3 position_m = Vector3::Zero();
  Vector3 slow_force_n = Vector3::Zero();   // the part of the force that a hand can follow
  Vector3 swing_force_n = Vector3::Zero();  // the last swing away from it
  double swings = 0.0;                      // recent ones
};

// A pure function: allocates nothing, locks nothing, reads no clock, never throws. The specification has
// passed check_specification(). Called by SafeDevice (haptic/safe_device.h) alone.
SafeForce make_safe(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input);

// One line for each flag that says something to the person, the gravest first, with newlines between; empty
// for none.
std::string safety_text(std::uint32_t flags);

}  // namespace spoonbill
