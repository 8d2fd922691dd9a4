#include "haptic/tick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/processor.h"
#include "haptic/virtual_device.h"
#include "tests/engine/allocations.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

DeviceReading reading_at(double x, double y) {
  return DeviceReading::from({Vector3(x, y, 0), Quaternion::Identity()}, 0);
}

Simulation held_handle(double force_scale) {
  Scene scene = small_handle();
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  scene.sculpting.force_scale = force_scale;
  return Simulation::make(scene, best_instruction_set()).value();
}

// A stiff body holds the tool away from the hand even if no force may reach the hand.
TEST(Tick, AForceScaleOfZeroIsNoForceOnAStiffBody) {
  Scene scene = held_handle(0.0).scene();
  scene.bodies[0].material.plastic = false;
  scene.bodies[0].material.youngs_modulus_pa = 2e9;
  Simulation simulation = Simulation::make(scene, best_instruction_set()).value();
  CouplingState coupling;
  for (int k = 0; k < 200; ++k) {
    const double height_m = 0.02 - 1e-4 * k;
    const TickResult result =
        tick(simulation, coupling, VirtualDevice::default_specification(), reading_at(0.03, height_m));
    EXPECT_EQ(result.force_n, Vector3::Zero());
  }
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  EXPECT_GT((snapshot.tool.proxy.position_m - snapshot.tool.device.position_m).norm(), 1e-3);
}

TEST(Tick, NoContactNoForce) {
  Simulation simulation = held_handle(100.0);
  CouplingState coupling;
  for (int k = 0; k < 100; ++k) {
    const TickResult result =
        tick(simulation, coupling, VirtualDevice::default_specification(), reading_at(0.05, 0.05));
    EXPECT_EQ(result.force_n, Vector3::Zero());
    EXPECT_FALSE(result.touching);
  }
}

// The haptic thread flushes denormal numbers, but the thread of a replay does not. A fading force must be the
// same in both threads; otherwise a live recording would not replay to the same states.
TEST(Tick, AFadingForceIsTheSameWhetherTheThreadFlushesDenormalsOrNot) {
  CouplingState fading[2];
  for (const int which : {0, 1}) {
    Simulation simulation = held_handle(100.0);
    fading[which].force_n = Vector3(0.0, 1e-300, 0.0);
    std::optional<DenormalsFlushed> flushed;
    if (which == 1) flushed.emplace();
    for (int k = 0; k < 60; ++k) {
      tick(simulation, fading[which], VirtualDevice::default_specification(), reading_at(0.05, 0.05));
    }
  }
  EXPECT_EQ(fading[0].force_n.y(), fading[1].force_n.y());
  EXPECT_LT(fading[0].force_n.y(), 1e-307);
}

TEST(Tick, PushedMaterialPushesBackAndTheForceScalesIt) {
  double force[2];
  for (const int which : {0, 1}) {
    Simulation simulation = held_handle(which == 0 ? 5.0 : 10.0);
    CouplingState coupling;
    TickResult result;
    // The hand is at rest after 400 ticks, and the body soon after, so that damping adds no force.
    for (int k = 0; k < 1000; ++k) {
      result = tick(simulation, coupling, VirtualDevice::default_specification(),
                    reading_at(0.05, 0.009 - 1e-5 * std::min(k, 400)));
    }
    EXPECT_TRUE(result.touching);
    force[which] = result.force_n.y();
  }
  EXPECT_GT(force[0], 1e-4);
  // The ratio is not exactly 2: at the larger force scale the coupling is softer, so the tool presses a
  // little less on the material.
  EXPECT_NEAR(force[1] / force[0], 2.0, 0.1);
}

TEST(Tick, HeldPartIsAWallOfTheDevicesStiffness) {
  Simulation simulation = held_handle(1.0);
  CouplingState coupling;
  const DeviceSpecification specification = VirtualDevice::default_specification();
  const double surface = 0.0025 + 0.006, depth = 0.002;
  TickResult result;
  for (int k = 0; k < 600; ++k)
    result = tick(simulation, coupling, specification, reading_at(0.01, surface - depth));
  EXPECT_NEAR(result.force_n.y(), depth * specification.maximum_stiffness_n_per_m, 0.15);
}

TEST(Tick, ForceStaysWithinTheDevicesLimit) {
  Simulation simulation = held_handle(1e6);
  CouplingState coupling;
  const DeviceSpecification specification = VirtualDevice::default_specification();
  bool limited = false;
  for (int k = 0; k < 600; ++k) {
    const TickResult result =
        tick(simulation, coupling, specification, reading_at(k % 2 == 0 ? 0.05 : 0.01, 0.01 - 2e-5 * k));
    ASSERT_LE(result.force_n.norm(), specification.maximum_force_n * (1.0 + 1e-12));
    limited |= (result.flags & tick_flag_force_limited) != 0;
  }
  EXPECT_TRUE(limited);
}

// The coupling computes the speed of the hand from the whole time between two readings, including missed
// ticks. The expected force is that at the true speed, 0.2 m/s.
TEST(Coupling, MissedTicksDoNotMakeTheHandFaster) {
  DeviceSpecification specification = VirtualDevice::default_specification();
  const Vector3 displacement_m(5e-3, 0.0, 0.0);
  for (const std::uint32_t missed : {0U, 4U, 8U}) {
    CouplingState coupling;
    Vector3 force_n = Vector3::Zero();
    for (int k = 0; k < 100; ++k) {
      const Vector3 position_m(0.2 * k * (1.0 + missed) * tick_s, 0.0, 0.0);
      force_n = couple(coupling, specification, position_m, displacement_m, missed).force_n;
    }
    const double hold_s = (1.0 + missed) * 1e-3, stiffness = 700.0 * 1e-3 / hold_s;
    const double weight = 1.0 - std::pow(0.5, 1.0 + missed);
    const double damping = 2.0 * stiffness * (1.0 / weight - 0.5) * hold_s;
    EXPECT_NEAR(force_n.x(), stiffness * 5e-3 - damping * 0.2, 1e-9) << missed;
  }
}

TEST(Tick, AllocatesNothing) {
  Simulation simulation = held_handle(20.0);
  CouplingState coupling;
  const DeviceSpecification specification = VirtualDevice::default_specification();
  tick(simulation, coupling, specification, reading_at(0.05, 0.02));
  const std::size_t before = allocation_count();
  for (int k = 0; k < 500; ++k) tick(simulation, coupling, specification, reading_at(0.05, 0.012 - 2e-5 * k));
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
