#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "engine/simulation/simulation.h"
#include "haptic/safe_device.h"
#include "haptic/virtual_device.h"
#include "tests/engine/allocations.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

const DeviceSpecification device = VirtualDevice::default_specification();

SafetyInput wanting(double x_n) {
  SafetyInput input;
  input.requested_n = Vector3(x_n, 0.0, 0.0);
  return input;
}

SafetyState engaged_state() {
  SafetyState state;
  for (int tick = 0; tick < 1000; ++tick) make_safe(state, device, wanting(0.0));
  EXPECT_TRUE(state.engaged);
  EXPECT_EQ(state.gain, 1.0);
  return state;
}

// Returns the state after the force has reached a steady value.
SafetyState pressing_state(double x_n) {
  SafetyState state = engaged_state();
  for (int tick = 0; tick < 1000; ++tick) make_safe(state, device, wanting(x_n));
  EXPECT_EQ(state.force_n.x(), x_n);
  return state;
}

TEST(Safety, ForcesAreOffUntilTheWantedForceHasBeenSmallForAWhile) {
  SafetyState state;
  for (int tick = 0; tick < 5000; ++tick) {
    // The force is large in every seventh tick, so it is never small for ten ticks in a row.
    const SafeForce safe = make_safe(state, device, wanting(tick % 7 == 0 ? 3.0 : 0.1));
    ASSERT_EQ(safe.force_n, Vector3::Zero());
    ASSERT_EQ(safe.flags, safety_flag_waiting);
  }
  int ticks = 0;
  while (make_safe(state, device, wanting(0.1)).force_n.isZero(0.0)) ASSERT_LT(++ticks, 100);
  EXPECT_GE(ticks, 3);
}

TEST(Safety, ForceRampsInOverTheDevicesTime) {
  SafetyState state;
  while (!state.engaged) make_safe(state, device, wanting(0.0));
  double last = 0.0;
  const int ramp_ticks = static_cast<int>(std::lround(device.ramp_time_s / tick_s));
  for (int tick = 1; tick <= ramp_ticks; ++tick) {
    const SafeForce safe = make_safe(state, device, wanting(2.0));
    EXPECT_NEAR(safe.force_n.x(), 2.0 * tick / ramp_ticks, 1e-9);
    EXPECT_GT(safe.force_n.x(), last);
    last = safe.force_n.x();
  }
  EXPECT_EQ(make_safe(state, device, wanting(2.0)).flags, safety_flag_none);
}

TEST(Safety, PassesOnWhatNeedsNoLimit) {
  SafetyState state = pressing_state(1.5);
  for (int tick = 0; tick < 2000; ++tick) {
    // The force oscillates at 10 Hz, which is as fast as a hand can move.
    const double wanted = 1.5 + std::sin(2.0 * std::numbers::pi * 10.0 * tick * tick_s);
    const SafeForce safe = make_safe(state, device, wanting(wanted));
    ASSERT_EQ(safe.force_n.x(), wanted);
    ASSERT_EQ(safe.flags, safety_flag_none);
  }
}

TEST(Safety, LimitsTheNormAndKeepsTheDirection) {
  SafetyState state = engaged_state();
  SafetyInput input;
  input.requested_n = Vector3(300.0, 400.0, 0.0);
  SafeForce safe;
  for (int tick = 0; tick < 100; ++tick) safe = make_safe(state, device, input);
  EXPECT_NEAR(safe.force_n.norm(), device.maximum_force_n, 1e-12);
  EXPECT_NEAR(safe.force_n.y() / safe.force_n.x(), 4.0 / 3.0, 1e-12);
  EXPECT_EQ(safe.flags, safety_flag_force_limited);
  input.requested_n.setConstant(std::numeric_limits<double>::max());
  EXPECT_LE(make_safe(state, device, input).force_n.norm(), device.maximum_force_n * (1.0 + 1e-12));
}

TEST(Safety, AJumpComesInNoFasterThanTheForceMayChange) {
  SafetyState state = engaged_state();
  const double most = device.maximum_force_rate_n_per_s * tick_s;
  const SafeForce first = make_safe(state, device, wanting(3.0));
  EXPECT_NEAR(first.force_n.x(), most, 1e-12);
  EXPECT_EQ(first.flags, safety_flag_change_limited);
  EXPECT_NEAR(make_safe(state, device, wanting(3.0)).force_n.x(), 2.0 * most, 1e-12);
  EXPECT_NEAR(make_safe(state, device, wanting(-3.0)).force_n.x(), most, 1e-12);
}

// Expects the fault to cut the force. A cut may exceed the limit on the rate of the force; nothing else may.
void expect_cut(const SafetyInput& fault, std::uint32_t flag) {
  SafetyState state = pressing_state(3.0);
  ASSERT_GT(3.0, device.maximum_force_rate_n_per_s * tick_s);
  const SafeForce safe = make_safe(state, device, fault);
  EXPECT_EQ(safe.force_n, Vector3::Zero());
  EXPECT_EQ(safe.flags, flag | safety_flag_cut);
  EXPECT_EQ(safe.reset_proxy, flag != safety_flag_stale);
  // The hand stays at the position that it has at the fault.
  const auto wanting_there = [&fault](double x_n) {
    SafetyInput input = wanting(x_n);
    if (fault.position_m.allFinite()) input.position_m = fault.position_m;
    return input;
  };
  // The fault stays reported while the force waits and ramps up again.
  for (int tick = 0; tick < 100; ++tick) {
    const SafeForce waiting = make_safe(state, device, wanting_there(3.0));
    EXPECT_EQ(waiting.force_n, Vector3::Zero());
    EXPECT_EQ(waiting.flags, flag | safety_flag_waiting);
    EXPECT_FALSE(waiting.reset_proxy);
  }
  for (int tick = 0; tick < 20; ++tick) make_safe(state, device, wanting_there(0.0));
  EXPECT_EQ(make_safe(state, device, wanting_there(0.0)).flags, flag | safety_flag_ramping);
  for (int tick = 0; tick < 200; ++tick) make_safe(state, device, wanting_there(0.0));
  EXPECT_EQ(make_safe(state, device, wanting_there(1.0)).force_n.x(), 1.0);
}

TEST(Safety, FaultsGiveZeroForceInTheirTick) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    SafetyInput fault = wanting(3.0);
    fault.requested_n.z() = bad;
    expect_cut(fault, safety_flag_not_finite);
    fault = wanting(3.0);
    fault.position_m.y() = bad;
    expect_cut(fault, safety_flag_not_finite);
  }
  SafetyInput fault = wanting(3.0);
  fault.stale = true;
  expect_cut(fault, safety_flag_stale);
  for (const std::uint64_t dropped : {std::uint64_t{9}, std::numeric_limits<std::uint64_t>::max()}) {
    fault = wanting(3.0);
    fault.dropped_ticks = dropped;
    expect_cut(fault, safety_flag_stalled);
  }
  fault = wanting(3.0);
  fault.position_m.z() = 1.01 * jump_speed_factor * device.maximum_speed_m_per_s * tick_s;
  expect_cut(fault, safety_flag_jumped);
}

TEST(Safety, AFewDroppedTicksCutNothing) {
  SafetyState state = pressing_state(3.0);
  SafetyInput input = wanting(3.0);
  input.dropped_ticks = 8;
  input.position_m.x() = 0.99 * 9.0 * tick_s * device.maximum_speed_m_per_s;
  const SafeForce safe = make_safe(state, device, input);
  EXPECT_EQ(safe.force_n.x(), 3.0);
  EXPECT_FALSE(safe.reset_proxy);
}

TEST(Safety, FewerThanTwoHundredTicksASecondGetNoForce) {
  for (const std::uint64_t dropped : {1U, 4U, 5U, 8U}) {
    SafetyState state = pressing_state(3.0);
    SafetyInput input = wanting(3.0);
    input.dropped_ticks = dropped;
    SafeForce safe;
    for (int tick = 0; tick < 100; ++tick) safe = make_safe(state, device, input);
    const bool is_slow = 1000 / (dropped + 1) < 200;
    EXPECT_EQ(safe.force_n.x(), is_slow ? 0.0 : 3.0) << dropped;
    EXPECT_EQ(safe.flags, is_slow ? safety_flag_slow | safety_flag_cut : safety_flag_softened) << dropped;
    // The loop runs at its full rate from here on. A force that was cut waits until the requested force is
    // small, as at the start.
    for (int tick = 0; tick < 300; ++tick) safe = make_safe(state, device, wanting(3.0));
    EXPECT_EQ(safe.flags, is_slow ? safety_flag_slow | safety_flag_waiting : safety_flag_none) << dropped;
  }
}

TEST(Safety, ABuzzIsCutWithinATenthOfASecond) {
  for (const double frequency_hz : {50.0, 100.0, 250.0, 500.0}) {
    SafetyState state = pressing_state(1.0);
    int tick = 0;
    SafeForce safe;
    while ((safe.flags & safety_flag_buzzing) == 0) {
      const double phase = 2.0 * std::numbers::pi * frequency_hz * (tick + 0.5) * tick_s;
      safe = make_safe(state, device, wanting(1.0 + 0.8 * std::sin(phase)));
      ASSERT_LT(++tick, 100) << frequency_hz << " Hz";
    }
    EXPECT_EQ(safe.force_n, Vector3::Zero());
    EXPECT_EQ(safe.flags, safety_flag_buzzing | safety_flag_cut);
    EXPECT_EQ(make_safe(state, device, wanting(1.0)).flags, safety_flag_buzzing | safety_flag_waiting);
  }
}

TEST(Safety, ATremblingHandAndAWeakRattleAreNoBuzz) {
  SafetyState state = pressing_state(1.0);
  for (int tick = 0; tick < 5000; ++tick) {
    const double tremor = 1.5 * std::sin(2.0 * std::numbers::pi * 12.0 * tick * tick_s);
    const double rattle = 0.1 * (tick % 2 == 0 ? 1.0 : -1.0);
    ASSERT_EQ(make_safe(state, device, wanting(1.0 + tremor + rattle)).flags & safety_flag_buzzing, 0u);
  }
}

TEST(Safety, FadesOutsideTheWorkspace) {
  for (const auto& [share, expected] : {std::pair{0.99, 1.0}, {1.05, 0.5}, {1.1, 0.0}, {5.0, 0.0}}) {
    SafetyState state = engaged_state();
    SafetyInput input = wanting(2.0);
    input.position_m = Vector3(0.0, share * device.workspace_radius_m, 0.0);
    state.position_m = input.position_m;
    SafeForce safe;
    for (int tick = 0; tick < 20; ++tick) safe = make_safe(state, device, input);
    EXPECT_NEAR(safe.force_n.x(), 2.0 * expected, 1e-9) << share;
    EXPECT_EQ(safe.flags, share > 1.0 ? safety_flag_outside : safety_flag_none);
  }
}

TEST(Safety, FadesForAFastHand) {
  for (const auto& [share, expected] : {std::pair{0.9, 1.0}, {1.5, 0.5}, {2.5, 0.0}}) {
    SafetyState state = engaged_state();
    SafetyInput input = wanting(2.0);
    input.dropped_ticks = 1;  // two ticks have passed between the positions
    SafeForce safe;
    for (int tick = 0; tick < 20; ++tick) {
      input.position_m.x() += share * device.maximum_speed_m_per_s * 2.0 * tick_s;
      safe = make_safe(state, device, input);
    }
    EXPECT_NEAR(safe.force_n.x(), 2.0 * expected, 1e-9) << share;
    EXPECT_EQ((safe.flags & safety_flag_fast) != 0, share > 1.0);
  }
}

TEST(Safety, ADeadManButtonMustBeHeldWhereTheDeviceHasOne) {
  DeviceSpecification with_button = device;
  with_button.dead_man_buttons = 2;
  SafetyState state;
  SafetyInput input = wanting(0.0);
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_EQ(make_safe(state, with_button, input).flags, safety_flag_dead_man | safety_flag_cut);
  }
  input.buttons = 3;
  for (int tick = 0; tick < 1000; ++tick) make_safe(state, with_button, input);
  input.requested_n.x() = 3.0;
  for (int tick = 0; tick < 10; ++tick) make_safe(state, with_button, input);
  EXPECT_EQ(make_safe(state, with_button, input).force_n.x(), 3.0);
  input.buttons = 1;
  EXPECT_EQ(make_safe(state, with_button, input).force_n, Vector3::Zero());
}

TEST(Safety, AllocatesNothing) {
  SafetyState state = engaged_state();
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 1000; ++tick) {
    SafetyInput input = wanting(tick % 5);
    input.stale = tick == 500;
    make_safe(state, device, input);
  }
  EXPECT_EQ(allocation_count(), before);
}

TEST(Safety, EveryFlagHasItsLine) {
  EXPECT_EQ(safety_text(safety_flag_none), "");
  std::set<std::string> lines;
  for (std::uint32_t flag = safety_flag_not_finite; flag <= safety_flag_softened; flag <<= 1) {
    const std::string line = safety_text(flag);
    EXPECT_FALSE(line.empty()) << flag;
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_TRUE(lines.insert(line).second) << line;
  }
  EXPECT_EQ(safety_text(safety_flag_waiting | safety_flag_stale | safety_flag_cut),
            safety_text(safety_flag_stale) + '\n' + safety_text(safety_flag_waiting));
}

TEST(Specification, RefusesWhatTheSafetyChainCannotKeep) {
  EXPECT_TRUE(check_specification(device).ok());
  DeviceSpecification broken = device;
  broken.ramp_time_s = -1.0;
  EXPECT_EQ(check_specification(broken).error().code, ErrorCode::out_of_range);
  EXPECT_EQ(check_specification(broken).error().field, "ramp_time_s");
  EXPECT_EQ(Refusal(check_specification(broken)), Refusal(ErrorCode::out_of_range, "ramp_time_s"));
  broken = device;
  broken.maximum_force_n = std::nan("");
  EXPECT_FALSE(check_specification(broken).ok());
}

}  // namespace
}  // namespace spoonbill
