// Tests that a wall never gives a hand more energy than the wall has received, which would kick the hand.
// Random hands press walls of the device's highest stiffness. The work of the force on the hand is summed
// tick by tick (the passivity observer of Hannaford & Ryu 2002).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "engine/simulation/simulation.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// Largest energy, in joules, that the hand may seem to receive because positions are rounded to nanometres:
// at the highest force, over the 2,000 ticks of a press, with all errors of one sign (3.3 N * 0.5 nm * 2000).
constexpr double rounding_j = 3.3e-6;

struct WallPress {
  Hand hand;
  double depth_m = 0.0;       // depth of the hand's target below the wall's surface
  double frequency_hz = 0.0;  // frequency at which the target moves in and out
};

double evenly(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

double scaled(std::mt19937_64& random, double low, double high) {
  return std::exp(evenly(random, std::log(low), std::log(high)));
}

// Returns a random press within the ranges of virtual_device.h. The hand is stable, and its damping is
// between none and critical.
WallPress random_press(std::mt19937_64& random) {
  WallPress press;
  Hand& hand = press.hand;
  hand.mass_kg = scaled(random, hand_mass_range_kg.low, hand_mass_range_kg.high);
  const double stiffest = std::min(hand_stiffness_range_n_per_m.high, hand.mass_kg / (tick_s * tick_s));
  hand.stiffness_n_per_m = scaled(random, hand_stiffness_range_n_per_m.low, stiffest);
  const double critical = 2.0 * std::sqrt(hand.mass_kg * hand.stiffness_n_per_m);
  const double damping = evenly(random, 0.0, 1.0) < 0.3 ? 0.0 : evenly(random, 0.0, critical);
  hand.damping_n_s_per_m = std::min(hand_damping_range_n_s_per_m.high, damping);
  press.depth_m = evenly(random, 1e-3, 1e-2);
  press.frequency_hz = evenly(random, 0.5, 5.0);
  return press;
}

struct Energy {
  double given_most_j = 0.0;  // largest net energy that the hand had received at any time
  double taken_j = 0.0;       // all energy that the wall took; energy that it gave back is not subtracted
};

// Moves a hand from above the wall, whose surface is at `surface_m`, into the wall and out again. `wall`
// returns the force for a reading; `next_hold` returns for how many milliseconds this force is held.
template <class Wall, class NextHold>
Energy press_wall(const WallPress& press, const Vector3& surface_m, Wall wall, NextHold next_hold) {
  constexpr double clearance_m = 0.005;
  constexpr int ticks = 2000;
  HandTarget target;
  target.pose.position_m = surface_m + Vector3(0.0, clearance_m, 0.0);
  VirtualDevice device = VirtualDevice::make(press.hand, target).value();
  Energy energy;
  double sum_j = 0.0;
  Vector3 force_n = Vector3::Zero(), before_m = device.position_m();
  int hold = 1, held = 0;
  for (int k = 1; k <= ticks; ++k) {
    const double way = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * press.frequency_hz * k * tick_s);
    target.pose.position_m.y() = surface_m.y() + clearance_m - way * (clearance_m + press.depth_m);
    device.set_target(target);
    DeviceReading reading = *device.read();
    const double work_j = force_n.dot(device.position_m() - before_m);
    before_m = device.position_m();
    sum_j += work_j;
    energy.given_most_j = std::max(energy.given_most_j, sum_j);
    energy.taken_j += std::max(0.0, -work_j);
    if (++held < hold) continue;
    reading.missed = static_cast<std::uint32_t>(std::exchange(held, 0) - 1);
    hold = next_hold();
    force_n = wall(reading);
    device.set_force(force_n);
  }
  return energy;
}

template <class Wall>
Energy press_wall(const WallPress& press, const Vector3& surface_m, Wall wall) {
  return press_wall(press, surface_m, wall, [] { return 1; });
}

Energy press_rigid_wall(const WallPress& press, double stiffness_n_per_m,
                        const std::function<int()>& next_hold) {
  DeviceSpecification specification = VirtualDevice::default_specification();
  specification.maximum_stiffness_n_per_m = stiffness_n_per_m;
  CouplingState coupling;
  return press_wall(
      press, Vector3::Zero(),
      [&](const DeviceReading& reading) {
        const Vector3 position_m = reading.pose().position_m;
        const Vector3 depth_m(0.0, std::max(0.0, -position_m.y()), 0.0);
        return couple(coupling, specification, position_m, depth_m, reading.missed).force_n;
      },
      next_hold);
}

// A wall is harder to keep passive if the hand is light and little damped. The hand of 0.2 kg and 3 N s/m is
// therefore lighter and less damped than measured hands: van Beek et al. (Scientific Reports 5:18004, 2015)
// measured 0.55 kg, 6.5 N s/m and 135 N/m at an arm's end. A hand adds no energy of its own at these
// frequencies (Hogan, ICRA 1989).
TEST(Passivity, AWallWhoseForceIsHeldForSeveralTicksGivesBackNoMoreThanItTook) {
  std::mt19937_64 random(25);
  const auto random_hold = [&random](int longest) {
    return 1 + static_cast<int>(random() % static_cast<unsigned>(longest));
  };
  const std::vector<std::pair<const char*, std::function<int()>>> rates = {
      {"1000 Hz", [] { return 1; }},
      {"500 Hz", [] { return 2; }},
      {"250 Hz", [] { return 4; }},
      {"1 to 4 ms", [&] { return random_hold(4); }},
      {"1 to 9 ms", [&] { return random_hold(9); }},
      {"1 ms, seldom up to 9", [&] { return random() % 40 == 0 ? random_hold(9) : 1; }}};
  for (const auto& [name, next_hold] : rates) {
    double taken_j = 0.0, given_j = 0.0;
    for (int run = 0; run < random_cases(200, 2000); ++run) {
      WallPress press = random_press(random);
      press.hand.mass_kg = 0.2;
      press.hand.damping_n_s_per_m = 3.0;
      press.hand.stiffness_n_per_m = evenly(random, 20.0, 500.0);
      const Energy energy = press_rigid_wall(press, run % 2 == 0 ? 700.0 : 2000.0, next_hold);
      given_j = std::max(given_j, energy.given_most_j);
      taken_j += energy.taken_j;
    }
    EXPECT_LE(given_j, rounding_j) << name;
    EXPECT_GT(taken_j, 0.02) << name;
  }
}

TEST(Passivity, ARigidWallOfTheHighestStiffnessGivesBackNoMoreThanItTook) {
  std::mt19937_64 random(21);
  const DeviceSpecification specification = VirtualDevice::default_specification();
  double taken_j = 0.0;
  for (int run = 0; run < 200; ++run) {
    const WallPress press = random_press(random);
    CouplingState coupling;
    const Energy energy = press_wall(press, Vector3::Zero(), [&](const DeviceReading& reading) {
      const Vector3 position_m = reading.pose().position_m;
      const double depth_m = std::max(0.0, -position_m.y());
      return couple(coupling, specification, position_m, Vector3(0.0, depth_m, 0.0)).force_n;
    });
    EXPECT_LE(energy.given_most_j, rounding_j)
        << press.hand.mass_kg << " kg, " << press.hand.stiffness_n_per_m << " N/m, "
        << press.hand.damping_n_s_per_m << " N s/m, " << press.depth_m << " m at " << press.frequency_hz
        << " Hz; took " << energy.taken_j << " J";
    taken_j += energy.taken_j;
  }
  // The walls absorbed at least a millijoule per press on average, which they could have given back.
  EXPECT_GT(taken_j, 0.2);
}

Scene scene_to_press() {
  Scene scene = small_handle();
  scene.bodies[0].material.youngs_modulus_pa = 1e6;
  scene.bodies[0].material.plastic = false;
  scene.planes.push_back({Vector3(0.03, 0, 0), Vector3::UnitX()});
  return scene;
}

// Presses the handle at `x_m`: either its fixed part, which acts as a wall, or the part that gives way.
void expect_simulation_passive(double x_m, int runs, unsigned seed) {
  std::mt19937_64 random(seed);
  const DeviceSpecification specification = VirtualDevice::default_specification();
  const Vector3 surface_m(x_m, 0.0025 + 0.006, 0.0);
  for (int run = 0; run < runs; ++run) {
    const WallPress press = random_press(random);
    Simulation simulation = Simulation::make(scene_to_press(), best_instruction_set()).value();
    CouplingState coupling;
    const Energy energy = press_wall(press, surface_m, [&](const DeviceReading& reading) {
      return tick(simulation, coupling, specification, reading).force_n;
    });
    EXPECT_LE(energy.given_most_j, rounding_j)
        << press.hand.mass_kg << " kg, " << press.hand.stiffness_n_per_m << " N/m, "
        << press.hand.damping_n_s_per_m << " N s/m, " << press.depth_m << " m at " << press.frequency_hz
        << " Hz; took " << energy.taken_j << " J";
  }
}

int simulated_runs() {
  return random_cases(is_full_run() ? 3 : 1, 24);
}

TEST(Passivity, TheHeldPartGivesBackNoMoreThanItTook) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  expect_simulation_passive(0.01, simulated_runs(), 22);
}

TEST(Passivity, ABodyThatBendsGivesBackNoMoreThanItTook) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  expect_simulation_passive(0.05, simulated_runs(), 23);
}

}  // namespace
}  // namespace spoonbill
