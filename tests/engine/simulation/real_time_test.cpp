// Tests the inertia scales of a simulation's bodies, and sculpting in real time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/bspline/reparameterise.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

// Returns a scene with two handles, one above the other without contact. The upper one is four times as
// stiff.
Scene two_handles() {
  Scene scene = small_handle();
  scene.bodies[0].material = silicone();
  Body upper = scene.bodies[0];
  upper.name = "upper";
  upper.material.youngs_modulus_pa *= 4.0;
  for (double& y : upper.surface.net.y) y += 0.03;
  scene.bodies.push_back(std::move(upper));
  return scene;
}

const FixingPlane plane_through_all{Vector3(0.02, 0, 0), Vector3::UnitX()};

Material rigid_steel() {
  Material material = silicone();
  material.name = "steel";
  material.youngs_modulus_pa = 193e9;
  return material;
}

double first_node_y(const Simulation& simulation, int body = 0) {
  return simulation.lattice(body).position(0).y();
}

TEST(InertiaScale, IsSharedByBodiesThatNothingFixes) {
  Simulation simulation = simulate(two_handles());
  const double shared = simulation.inertia_scale(0);
  EXPECT_GT(shared, 1.0);
  EXPECT_EQ(simulation.inertia_scale(1), shared);
  ASSERT_TRUE(simulation.apply(PlacePlane{plane_through_all}).ok());
  EXPECT_NEAR(simulation.inertia_scale(1) / shared, 1.0, 1e-5);
  EXPECT_NEAR(simulation.inertia_scale(0) / std::max(1.0, 0.25 * shared), 1.0, 0.1)
      << "each fixed body has its own, which grows with its stiffness";
  ASSERT_TRUE(simulation.apply(RemovePlanes{}).ok());
  EXPECT_EQ(simulation.inertia_scale(0), simulation.inertia_scale(1));
}

TEST(InertiaScale, OfAnImplicitBodyIsThatOfTheOthersUnlessItIsFixed) {
  Scene scene = two_handles();
  scene.bodies[1].material = rigid_steel();
  Simulation simulation = simulate(scene);
  EXPECT_GT(simulation.inertia_scale(0), 1.0);
  EXPECT_EQ(simulation.inertia_scale(1), simulation.inertia_scale(0));
  ASSERT_TRUE(simulation.apply(PlacePlane{plane_through_all}).ok());
  EXPECT_GT(simulation.inertia_scale(0), 1.0);
  EXPECT_EQ(simulation.inertia_scale(1), 1.0);
  Scene alone = small_handle();
  alone.bodies[0].material = rigid_steel();
  EXPECT_EQ(simulate(alone).inertia_scale(), 1.0);
}

TEST(InertiaScale, FallsWithTheSubsteps) {
  Simulation simulation = simulate(two_handles());
  double last = simulation.inertia_scale();
  for (const int substeps : {3, 1}) {
    Tool tool = simulation.scene().tool;
    tool.substeps = substeps;
    ASSERT_TRUE(simulation.apply(SetTool{tool}).ok());
    EXPECT_EQ(simulation.substeps(), substeps);
    EXPECT_GT(simulation.inertia_scale(), last);
    last = simulation.inertia_scale();
  }
}

TEST(InertiaScale, IsAccountedForInTheState) {
  Simulation simulation = simulate(two_handles());
  const std::uint64_t before = simulation.state_hash();
  Tool tool = simulation.scene().tool;
  tool.substeps = 3;
  ASSERT_TRUE(simulation.apply(SetTool{tool}).ok());
  EXPECT_NE(simulation.state_hash(), before);
}

TEST(RealTime, GivesEveryBodyItsMassAndATickMoreSubsteps) {
  Simulation simulation = simulate(two_handles());
  EXPECT_EQ(simulation.substeps(), 6);
  EXPECT_GT(simulation.real_time_substeps(), 6);
  // With N^2 times the inertia, N times fewer substeps suffice. Damped springs need some more.
  EXPECT_GE(simulation.real_time_substeps(), std::floor(6.0 * std::sqrt(simulation.inertia_scale())));
  Sculpting sculpting = simulation.scene().sculpting;
  sculpting.real_time = true;
  ASSERT_TRUE(simulation.apply(SetSculpting{sculpting}).ok());
  for (const int body : {0, 1}) EXPECT_EQ(simulation.inertia_scale(body), 1.0);
  EXPECT_EQ(simulation.substeps(), simulation.real_time_substeps());
  simulation.advance(far_away);
  Snapshot snapshot;
  simulation.write_snapshot(snapshot);
  EXPECT_EQ(snapshot.tool.substeps, 6) << "as set";
  EXPECT_EQ(snapshot.substeps, simulation.substeps()) << "as taken";
  EXPECT_EQ(snapshot.real_time_substeps, simulation.real_time_substeps());
  EXPECT_EQ(snapshot.bodies[0].material.inertia_scale, 1.0);
  sculpting.real_time = false;
  ASSERT_TRUE(simulation.apply(SetSculpting{sculpting}).ok());
  EXPECT_EQ(simulation.substeps(), 6);
  EXPECT_GT(simulation.inertia_scale(), 1.0);
}

// A body falls at g / r with the inertia scale r, and at g in real time. This holds for springs and for the
// implicit solver.
TEST(RealTime, IsThatOfAFall) {
  for (const bool real_time : {false, true}) {
    for (const bool is_stiff : {false, true}) {
      Scene scene = two_handles();
      if (is_stiff) scene.bodies[0].material = rigid_steel();
      scene.sculpting.real_time = real_time;
      scene.sculpting.drag_per_s = 0.0;
      scene.sculpting.gravity_m_per_s2 = {0.0, -9.81, 0.0};
      Simulation simulation = simulate(scene);
      const double before[] = {first_node_y(simulation, 0), first_node_y(simulation, 1)};
      constexpr int ticks = 80;
      for (int tick = 0; tick < ticks; ++tick) simulation.advance(above(0.2, 0.0));
      const double scale = simulation.inertia_scale();
      EXPECT_EQ(scale == 1.0, real_time);
      const double expected = 0.5 * 9.81 / scale * 1e-6 * ticks * ticks;
      for (const int body : {0, 1}) {
        // In steps of the Euler method, a body falls farther than in exact free fall, by up to the distance
        // of one tick.
        EXPECT_NEAR((before[body] - first_node_y(simulation, body)) / expected, 1.0, 1.1 / ticks)
            << real_time << ", " << is_stiff << ", " << body;
      }
    }
  }
}

// Halves all elements of a surface.
void halve_elements(Surface& surface) {
  for (const Direction direction : {Direction::u, Direction::v}) {
    const std::vector<double> breaks = (direction == Direction::u ? surface.u : surface.v).breakpoints();
    for (std::size_t b = 1; b < breaks.size(); ++b) {
      surface = insert_knot(surface, direction, 0.5 * (breaks[b - 1] + breaks[b]), 1).value();
    }
  }
}

// The force of a pressed body at rest is the same with every inertia. The elements are so short, compared to
// the cells, that there are no more samples in real time.
TEST(RealTime, ChangesNoForceAtRest) {
  const auto force_n = [](int substeps, bool real_time) {
    Scene scene = small_handle();
    scene.bodies[0].material = silicone();
    for (int halvings = 0; halvings < 2; ++halvings) halve_elements(scene.bodies[0].surface);
    scene.bodies[0].lattice.counts.reset();
    scene.bodies[0].lattice.node_budget = 300;
    scene.planes.push_back({Vector3(0.012, 0, 0), Vector3::UnitX()});
    scene.planes.push_back({Vector3(0.048, 0, 0), -Vector3::UnitX()});
    scene.tool.substeps = substeps;
    scene.sculpting.real_time = real_time;
    scene.sculpting.is_critically_damped = true;
    Simulation simulation = simulate(scene);
    double sum = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      const double pressed_m = 1e-3 * std::min(1.0, tick / 400.0);
      const Reaction reaction = simulation.advance(above(0.03, 0.0085 - pressed_m));
      if (tick >= 900) sum += reaction.force_n.y() / 100.0;
    }
    return sum;
  };
  const double expected = force_n(6, true);
  EXPECT_GT(expected, 0.0);
  for (const int substeps : {2, 6}) EXPECT_NEAR(force_n(substeps, false) / expected, 1.0, 0.02) << substeps;
}

}  // namespace
}  // namespace spoonbill
