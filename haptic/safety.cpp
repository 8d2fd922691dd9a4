#include "haptic/safety.h"

#include <algorithm>
#include <cmath>

#include "engine/simulation/simulation.h"

namespace spoonbill {

namespace {

constexpr int quiet_ticks_needed = 10;

// A hand moves a handbreadth meanwhile, and a force from before says nothing about where it is now. Shorter
// ones are held by the limit on the change.
constexpr std::uint64_t stall_ticks = 25;

// The force fades from the workspace's radius to this many times it.
constexpr double workspace_end = 1.1;
// And from the highest speed to this many times it.
constexpr double speed_end = 2.0;

// What is slower than 20 Hz a hand can follow: 1 - exp(-2 pi 20 Hz tick_s).
constexpr double slow_share = 0.118;
// Swings are forgotten within 100 ticks, so that a steady buzz of f Hz counts to 0.2 f. A hand's fastest
// tremor, at 12 Hz, reaches 2.4.
constexpr double swing_memory = 0.99;
constexpr double most_swings = 5.0;

Vector3 shortened(const Vector3& vector, double limit) {
  const double norm = vector.stableNorm();
  return norm > limit ? Vector3(vector * (limit / norm)) : vector;
}

// 1 up to `begin`, 0 from `end` on.
double fade(double value, double begin, double end) {
  return std::clamp((end - value) / (end - begin), 0.0, 1.0);
}

std::uint32_t faults_of(const DeviceSpecification& specification, const SafetyInput& input) {
  std::uint32_t faults = safety_flag_none;
  if (!input.wanted_n.allFinite() || !input.position_m.allFinite()) faults |= safety_flag_not_finite;
  if (input.stale) faults |= safety_flag_stale;
  if (input.dropped_ticks >= stall_ticks) faults |= safety_flag_stalled;
  const std::uint32_t held = input.buttons & specification.dead_man_buttons;
  if (held != specification.dead_man_buttons) faults |= safety_flag_dead_man;
  if (input.no_device) faults |= safety_flag_no_device;
  return faults;
}

// Zero force now, and all from the beginning.
SafeForce cut(SafetyState& state, std::uint32_t faults) {
  state = SafetyState{};
  state.cause = faults;
  SafeForce safe;
  safe.flags = faults | safety_flag_cut;
  safe.reset_proxy = (faults & safety_flag_stalled) != 0;
  return safe;
}

void engage_when_quiet(SafetyState& state, const DeviceSpecification& specification,
                       const Vector3& wanted_n) {
  const bool quiet = wanted_n.stableNorm() < specification.quiet_force_n;
  state.quiet_ticks = quiet ? state.quiet_ticks + 1 : 0;
  state.engaged = state.quiet_ticks >= quiet_ticks_needed;
}

double speed_of(const SafetyState& state, const SafetyInput& input) {
  if (!state.position_known) return 0.0;
  const double elapsed_s = (1.0 + static_cast<double>(input.dropped_ticks)) * tick_s;
  return (input.position_m - state.position_m).stableNorm() / elapsed_s;
}

void ramp(SafetyState& state, const DeviceSpecification& specification, SafeForce& safe) {
  if (state.gain >= 1.0) return;
  const double ramp_s = specification.ramp_time_s;
  state.gain = ramp_s > tick_s ? std::min(1.0, state.gain + tick_s / ramp_s) : 1.0;
  if (state.gain < 1.0) {
    safe.flags |= safety_flag_ramping | state.cause;
  } else {
    state.cause = safety_flag_none;
  }
}

// What the device may give here and now, were it not for the last tick's force.
Vector3 permitted(const SafetyState& state, const DeviceSpecification& specification,
                  const SafetyInput& input, double speed_m_per_s, SafeForce& safe) {
  const double limit_n = specification.maximum_force_n;
  if (input.wanted_n.stableNorm() > limit_n) safe.flags |= safety_flag_force_limited;
  const double fastest = specification.maximum_speed_m_per_s;
  const double slow = fade(speed_m_per_s, fastest, speed_end * fastest);
  if (slow < 1.0) safe.flags |= safety_flag_fast;
  const double radius = specification.workspace_radius_m;
  const double inside = fade(input.position_m.stableNorm(), radius, workspace_end * radius);
  if (inside < 1.0) safe.flags |= safety_flag_outside;
  return state.gain * slow * inside * shortened(input.wanted_n, limit_n);
}

Vector3 approached(const Vector3& from_n, const Vector3& to_n, const DeviceSpecification& specification,
                   SafeForce& safe) {
  const double most_n = specification.maximum_force_rate_n_per_s * tick_s;
  const Vector3 step_n = to_n - from_n;
  if (step_n.stableNorm() <= most_n) return to_n;
  safe.flags |= safety_flag_change_limited;
  return shortened(from_n + shortened(step_n, most_n), specification.maximum_force_n);
}

// Whether the force has swung to and fro too often. A swing counts when it exceeds the quiet force and points
// away from the one before.
bool is_buzzing(SafetyState& state, const DeviceSpecification& specification, const Vector3& force_n) {
  state.slow_force_n += slow_share * (force_n - state.slow_force_n);
  state.swings *= swing_memory;
  const Vector3 swing_n = force_n - state.slow_force_n;
  if (swing_n.norm() < specification.quiet_force_n) return false;
  if (swing_n.dot(state.swing_force_n) < 0.0) state.swings += 1.0;
  state.swing_force_n = swing_n;
  return state.swings > most_swings;
}

struct FlagText {
  SafetyFlag flag;
  const char* text;
};

constexpr FlagText flag_texts[] = {
    {safety_flag_no_device, "Force cut: the device does not answer"},
    {safety_flag_not_finite, "Force cut: a number was not finite"},
    {safety_flag_stale, "Force cut: the simulation did not keep up"},
    {safety_flag_stalled, "Force cut: the program was held up"},
    {safety_flag_buzzing, "Force cut: it was buzzing; touch more lightly, or lower the force scale"},
    {safety_flag_dead_man, "Force off: hold the safety button"},
    {safety_flag_waiting, "Force off until the tool is clear of the material"},
    {safety_flag_ramping, "Force is coming in"},
    {safety_flag_outside, "Force fades: the hand is outside the device's workspace"},
    {safety_flag_fast, "Force fades: move more slowly"},
    {safety_flag_force_limited, "Force at the device's limit: lower the force scale"},
    {safety_flag_change_limited, "Force held back: it would jump"},
};

}  // namespace

SafeForce make_safe(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input) {
  if (const std::uint32_t faults = faults_of(specification, input); faults != 0) return cut(state, faults);
  const double speed_m_per_s = speed_of(state, input);
  state.position_m = input.position_m;
  state.position_known = true;
  SafeForce safe;
  if (!state.engaged) {
    engage_when_quiet(state, specification, input.wanted_n);
    safe.flags = safety_flag_waiting | state.cause;
    return safe;
  }
  ramp(state, specification, safe);
  const Vector3 wanted_n = permitted(state, specification, input, speed_m_per_s, safe);
  safe.force_n = approached(state.force_n, wanted_n, specification, safe);
  if (is_buzzing(state, specification, safe.force_n)) return cut(state, safety_flag_buzzing);
  state.force_n = safe.force_n;
  return safe;
}

std::string safety_text(std::uint32_t flags) {
  std::string text;
  for (const FlagText& entry : flag_texts) {
    if ((flags & entry.flag) == 0) continue;
    if (!text.empty()) text += '\n';
    text += entry.text;
  }
  return text;
}

}  // namespace spoonbill
