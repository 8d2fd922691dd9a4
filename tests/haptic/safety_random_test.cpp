// Tests the safety chain with random inputs, which include every fault except a missing device and a force
// that is switched off.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <limits>

#include "engine/simulation/simulation.h"
#include "haptic/safe_device.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"
#include "tests/engine/random.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t all_faults = safety_flag_not_finite | safety_flag_stale | safety_flag_stalled |
                                     safety_flag_buzzing | safety_flag_dead_man | safety_flag_jumped |
                                     safety_flag_slow;

DeviceSpecification random_specification(Random& random) {
  DeviceSpecification specification;
  specification.maximum_force_n = random.once_in(10) ? 0.0 : random.log_uniform(0.5, 30.0);
  specification.workspace_radius_m = random.log_uniform(0.05, 1.0);
  specification.quiet_force_n = random.log_uniform(0.02, 1.0);
  specification.ramp_time_s = random.once_in(5) ? 0.0 : random.log_uniform(1e-3, 1.0);
  specification.maximum_force_rate_n_per_s = random.log_uniform(10.0, 1e5);
  specification.maximum_speed_m_per_s = random.log_uniform(0.1, 5.0);
  specification.dead_man_buttons = random.once_in(3) ? 2u : 0u;
  return specification;
}

// Generates inputs in which hand and force wander, jump, rest, buzz and break.
class RandomInput {
 public:
  explicit RandomInput(Random& random) : random_(random) {}

  SafetyInput next() {
    if (random_.once_in(300)) manner_ = random_.bits() % 5;
    SafetyInput input;
    input.requested_n = next_force();
    velocity_ =
        random_.once_in(200) ? Vector3(random_.log_uniform(1e-3, 20.0) * random_.direction()) : velocity_;
    position_ += velocity_ * tick_s;
    if (position_.norm() > 1.5 || random_.once_in(5000)) {
      position_ = random_.uniform(0, 1) * random_.direction();
    }
    input.position_m = position_;
    input.buttons = random_.once_in(10'000) ? 0u : 3u;
    if (random_.once_in(500)) input.dropped_ticks = random_.bits() % 30;
    break_something(input);
    return input;
  }

 private:
  Vector3 next_force() {
    switch (manner_) {
      case 0:
        return 0.01 * random_.direction();
      case 1:
        return random_.log_uniform(1e-3, 1e3) * random_.direction();
      case 2:
        return force_ = -force_;
      case 3:
        return force_ += random_.uniform(0.0, 0.5) * random_.direction();
      default:
        if (random_.once_in(100)) force_ = random_.log_uniform(0.01, 100.0) * random_.direction();
        return force_;
    }
  }

  void break_something(SafetyInput& input) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr std::array bad = {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity};
    const auto axis = static_cast<Eigen::Index>(random_.bits() % 3);
    if (random_.once_in(10'000)) input.requested_n[axis] = bad[random_.bits() % 3];
    if (random_.once_in(10'000)) input.position_m[axis] = bad[random_.bits() % 3];
    if (random_.once_in(1000)) input.requested_n[axis] = std::numeric_limits<double>::max();
    if (random_.once_in(10'000)) input.dropped_ticks = random_.bits() >> (random_.bits() % 64);
    input.stale = random_.once_in(10'000);
  }

  Random& random_;
  std::uint64_t manner_ = 0;
  Vector3 position_ = Vector3::Zero();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 force_ = Vector3::Ones();
};

// Returns true if the input is a fault, computed without the safety chain. `last_m` is the position of the
// previous tick; its coordinates are not finite if that tick had no valid position. `tick_count` is the
// number of ticks in the last 100 ms.
bool is_fault(const DeviceSpecification& specification, const SafetyInput& input, const Vector3& last_m,
              std::size_t tick_count) {
  if (input.stale || !input.requested_n.allFinite() || !input.position_m.allFinite()) return true;
  const double reach_m =
      5.0 * specification.maximum_speed_m_per_s * 1e-3 * (1.0 + static_cast<double>(input.dropped_ticks));
  if (last_m.allFinite() && (input.position_m - last_m).norm() > reach_m) return true;
  return input.dropped_ticks >= 9 || tick_count < 20 ||
         (specification.dead_man_buttons & ~input.buttons) != 0;
}

struct WatchedForces {
  std::uint64_t beyond_limit = 0, jumps = 0, not_cut = 0, cut_without_reason = 0, missed_resets = 0;
  std::uint64_t faults = 0, buzzes = 0, with_force = 0, limited = 0;
  Vector3 last_n = Vector3::Zero();
  Vector3 last_m = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());

  std::deque<std::uint64_t> times;  // times of the ticks in the last 100 ms, in milliseconds

  std::size_t count_ticks(std::uint64_t dropped) {
    if (dropped >= 9) times.clear();
    if (times.empty()) {  // at the start and after a stall, no tick counts as missed
      for (std::uint64_t time = 0; time < 100; ++time) times.push_back(time);
    } else {
      times.push_back(times.back() + dropped + 1);
    }
    while (times.front() + 100 <= times.back()) times.pop_front();
    return times.size();
  }

  // The relative tolerance allows for rounding of the norm.
  static constexpr double rounding = 1e-12;

  void watch(const DeviceSpecification& specification, const SafetyInput& input, const SafeForce& safe) {
    const double most_n = specification.maximum_force_rate_n_per_s * tick_s;
    const bool fault = is_fault(specification, input, last_m, count_ticks(input.dropped_ticks));
    last_m = input.position_m;
    const bool buzz = !fault && (safe.flags & (safety_flag_cut | safety_flag_buzzing)) ==
                                    (safety_flag_cut | safety_flag_buzzing);
    const bool cut = (safe.flags & safety_flag_cut) != 0;
    beyond_limit += !(safe.force_n.norm() <= specification.maximum_force_n * (1.0 + rounding));
    // The force may differ from the previous force by at most the limit, with a relative rounding error of
    // `rounding`.
    const double allowed_n = most_n + rounding * (most_n + specification.maximum_force_n);
    jumps += !cut && !((safe.force_n - last_n).norm() <= allowed_n);
    not_cut += (fault || cut) && !safe.force_n.isZero(0.0);
    cut_without_reason += cut != (fault || buzz) || (cut && (safe.flags & all_faults) == 0);
    missed_resets += !safe.reset_proxy && (input.dropped_ticks >= 9 || !input.position_m.allFinite());
    faults += fault;
    buzzes += buzz;
    with_force += !safe.force_n.isZero(0.0);
    limited += (safe.flags & safety_flag_change_limited) != 0;
    last_n = safe.force_n;
  }

  void expect_safe() const {
    EXPECT_EQ(beyond_limit, 0u);
    EXPECT_EQ(jumps, 0u);
    EXPECT_EQ(not_cut, 0u);
    EXPECT_EQ(cut_without_reason, 0u);
    EXPECT_EQ(missed_resets, 0u);
  }
};

TEST(SafetyAtRandom, LimitsHoldWhateverHappens) {
  const auto ticks = static_cast<std::uint64_t>(random_cases(300'000, 10'000'000));
  constexpr std::uint64_t ticks_a_device = 20'000;
  Random random(11);
  WatchedForces all;
  for (std::uint64_t done = 0; done < ticks; done += ticks_a_device) {
    const DeviceSpecification specification = random_specification(random);
    ASSERT_TRUE(check_specification(specification).ok());
    RandomInput inputs(random);
    SafetyState state;
    all.last_n.setZero();
    all.times.clear();
    all.last_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    for (std::uint64_t tick = 0; tick < ticks_a_device; ++tick) {
      const SafetyInput input = inputs.next();
      all.watch(specification, input, make_safe(state, specification, input));
    }
  }
  all.expect_safe();
  // Checks that each kind of event occurred often enough.
  EXPECT_GT(all.faults, ticks / 5000);
  EXPECT_GT(all.buzzes, ticks / 100'000);
  EXPECT_GT(all.with_force, ticks / 40);
  EXPECT_GT(all.limited, ticks / 1000);
}

Scene random_safety_scene(Random& random) {
  Scene scene = small_handle();
  Material& material = scene.bodies[0].material;
  material.youngs_modulus_pa = random.log_uniform(1e4, 1e9);
  material.poissons_ratio = random.uniform(0.26, 0.45);
  material.density_kg_per_m3 = random.log_uniform(500.0, 8000.0);
  material.damping_time_s = random.uniform(2e-6, 2e-5);
  material.plastic = random.once_in(2);
  scene.planes.push_back({Vector3(random.uniform(0.01, 0.04), 0, 0), Vector3::UnitX()});
  scene.tool.kind = random.once_in(3) ? ToolKind::point : ToolKind::sphere;
  scene.tool.action = static_cast<ToolAction>(random.bits() % tool_actions.size());
  scene.tool.radius_m = random.uniform(0.003, 0.008);
  scene.tool.substeps = 1 + static_cast<int>(random.bits() % 8);
  scene.sculpting.force_scale = random.log_uniform(0.1, 1e4);
  return scene;
}

// Moves a hand at random above and into the handle. At times the thread is late or the simulation stale.
WatchedForces sculpt(Random& random, int ticks) {
  auto made = Simulation::make(random_safety_scene(random), best_instruction_set());
  EXPECT_TRUE(made.ok()) << made.error().message;
  Simulation simulation = std::move(made).value();
  const double mass = random.log_uniform(0.02, 1.0), stiffness = random.uniform(50.0, 1000.0);
  HandTarget target;
  target.pose.position_m = Vector3(0.03, 0.02, 0.0);
  VirtualDevice device =
      VirtualDevice::make({mass, stiffness, 2.0 * std::sqrt(mass * stiffness)}, target).value();
  CouplingState coupling;
  SafetyState safety;
  WatchedForces watched;
  Vector3 from = target.pose.position_m, to = from;
  constexpr int stroke = 100;
  for (int k = 0; k < ticks; ++k) {
    if (k % stroke == 0) {
      from = to;
      to = Vector3(random.uniform(0.0, 0.06), random.uniform(-0.01, 0.02), random.uniform(-0.01, 0.01));
      target.buttons = random.once_in(2) ? button_main : 0u;
    }
    target.pose.position_m = from + (to - from) * ((k % stroke + 1.0) / stroke);
    device.set_target(target);
    SafetyInput input;
    input.requested_n = tick(simulation, coupling, device.specification(), *device.read()).force_n;
    input.position_m = device.position_m();
    input.stale = random.once_in(1000);
    if (random.once_in(300)) input.dropped_ticks = random.bits() % 60;
    const SafeForce safe = make_safe(safety, device.specification(), input);
    watched.watch(device.specification(), input, safe);
    device.set_force(safe.force_n);
  }
  return watched;
}

TEST(SafetyAtRandom, LimitsHoldWhileSculpting) {
  const int scenes = random_cases(is_full_run() ? 6 : 2, 60);
  Random random(12);
  std::uint64_t with_force = 0;
  for (int scene = 0; scene < scenes; ++scene) {
    const WatchedForces watched = sculpt(random, 1500);
    watched.expect_safe();
    with_force += watched.with_force;
  }
  EXPECT_GT(with_force, 0u);
}

}  // namespace
}  // namespace spoonbill
