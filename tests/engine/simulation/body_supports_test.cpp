// Tests supports that fix or move a body.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/simulation/body_loads.h"
#include "tests/engine/allocations.h"
#include "tests/engine/material/block.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/loaded_block.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

Support ramp(const BodyRegion& region, const Vector3& displacement_m, double duration_s) {
  return {region, SupportMotion{MotionKind::ramp, displacement_m, duration_s}};
}

Support oscillation(const BodyRegion& region, const Vector3& displacement_m, double frequency_hz) {
  SupportMotion motion;
  motion.kind = MotionKind::oscillation;
  motion.displacement_m = displacement_m;
  motion.frequency_hz = frequency_hz;
  return {region, motion};
}

TEST(SupportMotion, GoesItsWayWithoutAJerk) {
  const SupportMotion motion{MotionKind::ramp, Vector3(0, 0.01, 0), 2.0};
  EXPECT_EQ(displacement_at(motion, 0.0), Vector3(0, 0, 0));
  EXPECT_DOUBLE_EQ(displacement_at(motion, 1.0).y(), 0.005);
  EXPECT_EQ(displacement_at(motion, 2.0), Vector3(0, 0.01, 0));
  EXPECT_EQ(displacement_at(motion, 9.0), Vector3(0, 0.01, 0));
  double fastest = 0.0;
  for (int step = 0; step < 2000; ++step) {
    fastest = std::max(
        fastest,
        (displacement_at(motion, 1e-3 * (step + 1)) - displacement_at(motion, 1e-3 * step)).y() / 1e-3);
  }
  EXPECT_NEAR(fastest, top_speed_m_per_s(motion), 1e-6 * fastest);
}

// Compares the motion after the first period with the sine of the standard library.
TEST(SupportMotion, SwingsAsASine) {
  const SupportMotion motion = *oscillation({}, Vector3(0.002, 0, 0), 3.0).motion;
  EXPECT_EQ(displacement_at(motion, 0.0).x(), 0.0);
  double fastest = 0.0;
  for (int step = 0; step < 3000; ++step) {
    const double time = 1e-3 * step;
    fastest = std::max(
        fastest,
        std::abs(displacement_at(motion, time + 1e-6).x() - displacement_at(motion, time).x()) / 1e-6);
    if (time < 1.0 / 3.0) continue;
    EXPECT_NEAR(displacement_at(motion, time).x(), 0.002 * std::sin(6.0 * std::numbers::pi * time), 1e-14);
  }
  EXPECT_LE(fastest, top_speed_m_per_s(motion) * (1.0 + 1e-6));
  EXPECT_GT(fastest, top_speed_m_per_s(motion) * 0.99);
}

// The bar has a Poisson's ratio of 0, so the force is E A d / L up to the nonlinearity at a strain of 1e-3.
// Springs have a ratio of at least 0.2, so a bar of springs narrows, except at its fixed ends. This makes it
// slightly stiffer.
TEST(BodySupports, APulledEndBearsWhatABarSays) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    const double youngs = stepping == Stepping::springs ? 2e4 : 5e6, area = 1e-4, length = 0.06, way = 6e-5;
    Material material = elastic_material(youngs, 0.0, 1000.0);
    material.damping_time_s = 1e-4;
    LoadedBlock bar({0.01, 0.01, length}, {4, 4, 19}, material, stepping);
    bar.support({{block_start, {}}, ramp(block_end, Vector3(0, 0, way), 0.3)});
    for (int tick = 0; tick < 1500; ++tick) bar.tick(100.0);
    const double expected = youngs * area * way / length;
    const double allowed = stepping == Stepping::springs ? 0.01 : 3e-4;
    EXPECT_NEAR(bar.support_force_n(1).z() / expected, 1.0, allowed);
    EXPECT_NEAR(bar.support_force_n(0).z() / -expected, 1.0, allowed);
    const LatticeMesh& mesh = bar.lattice.mesh();
    for (int n = mesh.node_count() - 16; n < mesh.node_count(); ++n) {
      EXPECT_EQ(static_cast<float>(bar.lattice.displacement(n).z()), static_cast<float>(way));
    }
    // The displacement is linear between the ends.
    EXPECT_NEAR(bar.slice_m(9).z() / (0.5 * way), 1.0, 5e-4);
  }
}

// Fixed nodes have the support's position and velocity at the end of every tick.
TEST(BodySupports, MovesItsNodesExactly) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    Material material = elastic_material(stepping == Stepping::springs ? 2e4 : 5e6, 0.3, 1000.0);
    material.damping_time_s = 5e-5;
    LoadedBlock body({0.012, 0.012, 0.04}, {4, 4, 11}, material, stepping);
    const Support shaken = oscillation({{0.0, 0.3}}, Vector3(0.003, 0, 0.001), 8.0);
    body.support({shaken});
    for (int tick = 1; tick <= 500; ++tick) {
      body.tick(5.0);
      const Vector3 now = displacement_at(*shaken.motion, body.time_s),
                    before = displacement_at(*shaken.motion, body.time_s - 1e-3);
      for (const int n : body.supports.supports()[0].nodes) {
        ASSERT_LT((body.lattice.displacement(n) - now).norm(), 1e-9) << tick;
        ASSERT_LT((body.lattice.velocity(n) - (now - before) / 1e-3).norm(), 1e-5) << tick;
      }
      ASSERT_LT((body.slice_m(10) - now).norm(), 0.02) << tick;
    }
  }
}

// The support fixes one slice of the lattice. The implicit solver's block has fewer slices, so most of the
// slices that are tried lie between two slices of the block.
// Without the support, the body would fall by about 7 cm.
TEST(BodySupports, HoldWhatTheBlockHasNoNodeFor) {
  const Vector3 size_m(0.012, 0.012, 0.08), gravity_m_per_s2(0, 0, 9.81);
  const Material material = elastic_material(5e6, 0.3, 1000.0);
  for (int k = 30; k <= 34; ++k) {
    LoadedBlock bar(size_m, {5, 5, 65}, material, Stepping::implicitly);
    ASSERT_LT(bar.core->mesh().count[2], 33);
    bar.support({{{{k / 64.0, k / 64.0}}, {}}});
    for (int tick = 0; tick < 400; ++tick) bar.tick(50.0, gravity_m_per_s2);
    EXPECT_LT(bar.slice_m(0).norm(), 1e-4) << k;
    EXPECT_LT(bar.slice_m(64).norm(), 1e-4) << k;
    const double weight_n = gravity_m_per_s2.z() * bar.lattice.mass_kg();
    EXPECT_NEAR(bar.support_force_n(0).z() / -weight_n, 1.0, 1e-3) << k;
  }
}

// A motion that is faster than the waves in the lattice would invert cells. The support lags instead.
TEST(BodySupports, WaitsForALatticeThatItWouldOutrun) {
  LoadedBlock body({0.012, 0.012, 0.04}, {4, 4, 11}, elastic_material(2e3, 0.3, 1000.0), Stepping::springs);
  body.support({{block_start, {}}, ramp(block_end, Vector3(0, 0, 0.02), 0.01)});
  for (int tick = 0; tick < 10; ++tick) body.tick(5.0);
  EXPECT_LT(body.slice_m(10).z(), 0.01);
  EXPECT_GT(body.slice_m(10).z(), 0.0);
  for (int tick = 0; tick < 1000; ++tick) body.tick(5.0);
  EXPECT_NEAR(body.slice_m(10).z(), 0.02, 1e-8);
}

TEST(BodySupports, RefuseWhatHoldsNothing) {
  const LatticeMesh mesh = box_mesh({0.01, 0.01, 0.04}, {4, 4, 13});
  const auto refused = [&](const Support& support) {
    const auto made = BodySupports::make({support}, mesh);
    return made.ok() ? Error(ErrorCode::internal, "") : made.error();
  };
  const Error empty = refused({{{0.51, 0.52}}, {}});
  EXPECT_EQ(empty.code, ErrorCode::too_few);
  EXPECT_EQ(empty.field, "region");
  EXPECT_EQ(empty.message.substr(0, 13), "supports[0]: ");
  const Error fast = refused(oscillation({}, Vector3(0.5, 0, 0), 10.0));
  EXPECT_EQ(fast.code, ErrorCode::out_of_range);
  EXPECT_EQ(fast.field, "motion");
}

// Returns a handle of 60 mm along x. Its first tenth is fixed, and its last tenth is moved up and down.
Scene moved_handle() {
  Scene scene = small_handle();
  scene.bodies[0].material = silicone();
  scene.bodies[0].supports = {{{{0.0, 0.1}}, {}}, oscillation({{0.9, 1.0}}, Vector3(0, 0.002, 0), 2.0)};
  scene.tool.substeps = 2;
  return scene;
}

TEST(BodySupports, MoveTheSkin) {
  Scene scene = moved_handle();
  scene.bodies[0].supports[1] = ramp({{0.9, 1.0}}, Vector3(0, 0.002, 0), 0.3);
  scene.sculpting.is_critically_damped = true;
  Simulation simulation = simulate(scene);
  const Vector3 before = evaluate(simulation.surface(), 0.0, 0.06).position_m;
  for (int tick = 0; tick < 4000; ++tick) simulation.advance(far_away);
  const Vector3 now = evaluate(simulation.surface(), 0.0, 0.06).position_m;
  EXPECT_NEAR(now.y() - before.y(), 0.002, 2e-6) << "what the control net follows of it";
  EXPECT_GT(simulation.support_force_n(1).y(), 0.0);
  EXPECT_NEAR(simulation.support_force_n(1).y() / -simulation.support_force_n(0).y(), 1.0, 0.03);
}

TEST(BodySupports, GoOnAfterWhatElseHappens) {
  Simulation simulation = simulate(moved_handle());
  const auto at_end = [&] {
    return simulation.lattice().position(simulation.lattice().mesh().node_count() - 1).y();
  };
  const double rest = at_end();
  const auto run_to = [&](std::uint64_t tick) {
    while (simulation.tick() < tick) simulation.advance(far_away);
  };
  const auto way = [&](std::uint64_t tick) {
    return displacement_at(*moved_handle().bodies[0].supports[1].motion, 1e-3 * static_cast<double>(tick))
        .y();
  };
  run_to(600);
  const ShapeState then = simulation.shape();
  run_to(700);
  ASSERT_TRUE(simulation.restore(then).ok());
  run_to(800);
  EXPECT_NEAR(at_end() - rest, way(800), 1e-8) << "an undone stroke does not leave it behind";
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  run_to(900);
  EXPECT_NEAR(at_end() - rest, way(900), 1e-8);
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}).ok());
  ASSERT_TRUE(simulation.apply(SetMaterial{small_handle().bodies[0].material, 0}).ok());
  run_to(1000);
  EXPECT_NEAR(at_end() - rest, way(1000), 1e-8);
  const double held_at = at_end();
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.05, 0, 0), -Vector3::UnitX()}}).ok());
  run_to(1100);
  EXPECT_EQ(at_end(), held_at) << "what a plane holds stays";
  ASSERT_TRUE(simulation.apply(RemovePlanes{}).ok());
  run_to(1300);
  EXPECT_NE(at_end(), held_at);
}

TEST(BodySupports, AreTheSameOnEveryRunAndAllocateNothing) {
  Scene scene = moved_handle();
  scene.bodies[0].loads = {PressureLoad{{}, 50.0}, ForceLoad{{{0.4, 0.6}}, Vector3(0, -0.01, 0)},
                           PointLoad{0.25, 0.03, Vector3(0, 0, 0.002)}};
  scene.ground = Ground{Vector3(0, -0.01, 0)};
  for (const double youngs : {1e5, 2e9}) {
    scene.bodies[0].material.youngs_modulus_pa = youngs;
    Simulation first = simulate(scene), second = simulate(scene);
    first.advance(far_away);
    const std::size_t before = allocation_count();
    for (int tick = 0; tick < 300; ++tick) first.advance(far_away);
    EXPECT_EQ(allocation_count(), before);
    for (int tick = 0; tick < 301; ++tick) second.advance(far_away);
    EXPECT_EQ(first.state_hash(), second.state_hash());
  }
}

}  // namespace
}  // namespace spoonbill
