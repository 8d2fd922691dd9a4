#include "haptic/safe_device.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

namespace {

constexpr int quiet_ticks_needed = 10;

constexpr double lowest_tick_count = lowest_tick_rate_hz * tick_s * TickHistory::window_ms;

// Multiples of the workspace radius and of the maximum speed at which the force has faded to zero.
constexpr double workspace_end = 1.1;
constexpr double speed_end = 2.0;

Vector3 clamp_norm(const Vector3& vector, double limit) {
  const double norm = vector.stableNorm();
  return norm > limit ? Vector3(vector * (limit / norm)) : vector;
}

// Returns 1 up to `begin`, 0 from `end` on, and a linear ramp between.
double fade(double value, double begin, double end) {
  return std::clamp((end - value) / (end - begin), 0.0, 1.0);
}

std::uint32_t find_faults(const SafetyState& state, const DeviceSpecification& specification,
                          const SafetyInput& input) {
  std::uint32_t faults = safety_flag_none;
  if (!input.requested_n.allFinite() || !input.position_m.allFinite()) faults |= safety_flag_not_finite;
  if (input.stale) faults |= safety_flag_stale;
  if (is_stall(input.dropped_ticks)) faults |= safety_flag_stalled;
  if (static_cast<double>(state.ticks.count()) < lowest_tick_count) faults |= safety_flag_slow;
  const bool comparable = state.position_known && !input.no_device && input.position_m.allFinite();
  if (comparable && is_jump(specification, input.position_m - state.position_m, input.dropped_ticks)) {
    faults |= safety_flag_jumped;
  }
  const std::uint32_t pressed = input.buttons & specification.dead_man_buttons;
  if (pressed != specification.dead_man_buttons) faults |= safety_flag_dead_man;
  if (input.no_device) faults |= safety_flag_no_device;
  if (input.off) faults |= safety_flag_off;
  return faults;
}

constexpr std::uint32_t faults_with_proxy_reset =
    safety_flag_not_finite | safety_flag_stalled | safety_flag_jumped;

// Resets the chain, apart from the position of the hand and the history of ticks, and returns zero force.
SafeForce cut(SafetyState& state, const SafetyInput& input, std::uint32_t faults) {
  const TickHistory ticks = state.ticks;
  state = SafetyState{};
  state.ticks = ticks;
  state.cause = faults;
  state.position_known = !input.no_device && input.position_m.allFinite();
  if (state.position_known) state.position_m = input.position_m;
  SafeForce safe;
  safe.flags = faults | safety_flag_cut;
  safe.reset_proxy = (faults & faults_with_proxy_reset) != 0;
  return safe;
}

void engage_when_quiet(SafetyState& state, const DeviceSpecification& specification,
                       const Vector3& requested_n) {
  const bool quiet = requested_n.stableNorm() < specification.quiet_force_n;
  state.quiet_ticks = quiet ? state.quiet_ticks + 1 : 0;
  state.engaged = state.quiet_ticks >= quiet_ticks_needed;
}

double compute_speed(const Vector3& offset_m, std::uint64_t dropped_ticks) {
  return offset_m.stableNorm() / ((1.0 + static_cast<double>(dropped_ticks)) * tick_s);
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

// Returns the requested force, ramped in and reduced by the limits on force, speed and workspace.
Vector3 limit_force(const SafetyState& state, const DeviceSpecification& specification,
                    const SafetyInput& input, double speed_m_per_s, SafeForce& safe) {
  const double limit_n = specification.maximum_force_n;
  if (input.requested_n.stableNorm() > limit_n) safe.flags |= safety_flag_force_limited;
  const double speed_limit = specification.maximum_speed_m_per_s;
  const double slow = fade(speed_m_per_s, speed_limit, speed_end * speed_limit);
  if (slow < 1.0) safe.flags |= safety_flag_fast;
  const double radius = specification.workspace_radius_m;
  const double inside = fade(input.position_m.stableNorm(), radius, workspace_end * radius);
  if (inside < 1.0) safe.flags |= safety_flag_outside;
  return state.gain * slow * inside * clamp_norm(input.requested_n, limit_n);
}

Vector3 limit_change(const Vector3& from_n, const Vector3& to_n, const DeviceSpecification& specification,
                     SafeForce& safe) {
  const double maximum_n = specification.maximum_force_rate_n_per_s * tick_s;
  const Vector3 step_n = to_n - from_n;
  if (step_n.stableNorm() <= maximum_n) return to_n;
  safe.flags |= safety_flag_change_limited;
  return clamp_norm(from_n + clamp_norm(step_n, maximum_n), specification.maximum_force_n);
}

bool is_buzzing(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input) {
  const VibrationLimits limits{specification.quiet_force_n, specification.maximum_force_n};
  return detect_vibration(state.vibration, limits, input.requested_n, input.position_m, input.dropped_ticks);
}

struct FlagText {
  SafetyFlag flag;
  const char* text;
};

constexpr FlagText flag_texts[] = {
    {safety_flag_off, "Force switched off: Shift+Space switches it on"},
    {safety_flag_no_device, "Force cut: the device has no valid reading"},
    {safety_flag_jumped, "Force cut: the device reported an impossibly fast motion"},
    {safety_flag_not_finite, "Force cut: a number was not finite"},
    {safety_flag_stale, "Force cut: the simulation did not keep up"},
    {safety_flag_stalled, "Force cut: the program stalled"},
    {safety_flag_slow, "Force cut: fewer than 200 ticks a second; close other programs"},
    {safety_flag_buzzing, "Force cut: it was oscillating; touch more lightly, or lower the force scale"},
    {safety_flag_dead_man, "Force off: hold the safety button"},
    {safety_flag_waiting, "Force off until the tool is clear of the material"},
    {safety_flag_ramping, "Force is ramping in"},
    {safety_flag_outside, "Force fades: the hand is outside the device's workspace"},
    {safety_flag_fast, "Force fades: move more slowly"},
    {safety_flag_force_limited, "Force at the device's limit: lower the force scale"},
    {safety_flag_change_limited, "Force limited: it changes too fast"},
    {safety_flag_softened, "Force is softer: the program misses ticks"},
};

}  // namespace

bool is_jump(const DeviceSpecification& specification, const Vector3& offset_m, std::uint64_t dropped_ticks) {
  const double limit_m_per_s = jump_speed_factor * specification.maximum_speed_m_per_s;
  return !(compute_speed(offset_m, dropped_ticks) <= limit_m_per_s);
}

SafeForce make_safe(SafetyState& state, const DeviceSpecification& specification, const SafetyInput& input) {
  if (is_stall(input.dropped_ticks)) {
    state.ticks = TickHistory();
  } else {
    state.ticks.add(input.dropped_ticks);
  }
  if (const std::uint32_t faults = find_faults(state, specification, input); faults != 0) {
    return cut(state, input, faults);
  }
  const double speed_m_per_s =
      state.position_known ? compute_speed(input.position_m - state.position_m, input.dropped_ticks) : 0.0;
  state.position_m = input.position_m;
  state.position_known = true;
  SafeForce safe;
  if (state.ticks.find_longest_hold() > 1) safe.flags |= safety_flag_softened;
  if (!state.engaged) {
    engage_when_quiet(state, specification, input.requested_n);
    safe.flags |= safety_flag_waiting | state.cause;
    return safe;
  }
  if (is_buzzing(state, specification, input)) return cut(state, input, safety_flag_buzzing);
  ramp(state, specification, safe);
  const Vector3 requested_n = limit_force(state, specification, input, speed_m_per_s, safe);
  safe.force_n = limit_change(state.force_n, requested_n, specification, safe);
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

SafeDevice::SafeDevice(Device& device, const DeviceReading& last)
    : device_(&device), limits_(device.specification()), reading_(last) {
  SPOONBILL_ASSERT(check_specification(limits_).ok());
  SPOONBILL_ASSERT(last.is_valid());
}

SafeDevice::~SafeDevice() {
  device_->set_force(Vector3::Zero());
}

bool SafeDevice::has_jumped(const DeviceReading& reading) const {
  if (!position_known_) return false;
  const Vector3 offset_m = reading.pose().position_m - reading_.pose().position_m;
  return is_jump(limits_, offset_m, dropped_ticks_);
}

DeviceReading SafeDevice::read(std::uint64_t dropped_ticks) {
  const std::optional<DeviceReading> reading = device_->read();
  if (device_->is_playback() && reading) {
    reading_ = *reading;
    if (!workspace_centre_m_) workspace_centre_m_ = reading_.pose().position_m;
    return reading_;
  }
  dropped_ticks_ = dropped_ticks;
  const auto missed = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(dropped_ticks, std::numeric_limits<std::uint32_t>::max()));
  const bool answered = std::exchange(answers_, reading.has_value() && reading->is_valid());
  if (!answered || is_stall(dropped_ticks)) proxy_is_stale_ = true;
  if (!answers_) {
    position_known_ = false;
    reading_.buttons = button_hover;
    reading_.missed = missed;
    return reading_;
  }
  const bool jumped = has_jumped(*reading);
  position_known_ = true;
  reading_ = *reading;
  reading_.missed = missed;
  if (!workspace_centre_m_) workspace_centre_m_ = reading_.pose().position_m;
  if (!jumped) return reading_;
  DeviceReading pointing = reading_;
  pointing.buttons = button_hover;
  return pointing;
}

bool SafeDevice::consume_proxy_reset() {
  // Without a valid reading the tool touches nothing, so the reset waits until the device answers.
  return answers_ && std::exchange(proxy_is_stale_, false);
}

Vector3 SafeDevice::give(const Vector3& requested_n) {
  SafetyInput input;
  input.requested_n = requested_n;
  return give(input);
}

void SafeDevice::give_none() {
  SafetyInput input;
  input.stale = true;
  give(input);
}

Vector3 SafeDevice::give(SafetyInput input) {
  input.position_m = reading_.pose().position_m;
  if (workspace_centre_m_) input.position_m -= *workspace_centre_m_;
  input.buttons = reading_.buttons;
  input.dropped_ticks = dropped_ticks_;
  input.no_device = !answers_;
  input.off = !force_on_;
  const SafeForce safe = make_safe(state_, limits_, input);
  flags_ = safe.flags;
  // After a stall, the proxy was reset already, before the simulation advanced.
  const bool is_reset = (flags_ & safety_flag_stalled) != 0;
  if (!device_->is_playback()) proxy_is_stale_ = proxy_is_stale_ || (safe.reset_proxy && !is_reset);
  device_->set_force(safe.force_n);
  return safe.force_n;
}

}  // namespace spoonbill
