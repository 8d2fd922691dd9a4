#include "engine/simulation/refiner.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine/allocations.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// A stroke that the control net cannot follow: a small sphere presses and stays.
ToolInput small_press(int t) {
  return above(0.03, 0.0065 - 0.0035 * std::min(1.0, t / 400.0), true);
}

Scene scene_of_small_press(ToolReach reach) {
  Scene scene = small_handle();
  scene.planes = {{Vector3(0.012, 0, 0), Vector3::UnitX()}};
  scene.tool.radius_m = 0.002;
  scene.tool.reach = reach;
  return scene;
}

Scene two_bodies() {
  Scene scene = scene_of_small_press(ToolReach::whole);
  Body other = scene.bodies[0];
  other.name = "other";
  for (double& z : other.surface.net.z) z += 0.0125;
  scene.bodies.push_back(std::move(other));
  return scene;
}

Scene scene_with_ground() {
  Scene scene = scene_of_small_press(ToolReach::whole);
  scene.ground = Ground{};
  scene.ground->point_m = Vector3(0, -0.0026, 0);
  scene.sculpting.gravity_m_per_s2 = Vector3(0, -9.81, 0);
  return scene;
}

// One simulation refines by commands, the other by a refiner, which was made before the stroke. Both have the
// same state after every tick, and after an undo of all refinements.
void expect_same_states(const Scene& scene) {
  Simulation commanded = simulate(scene), refined = simulate(scene);
  Refiner refiner(refined);
  const ShapeState start = refined.shape();
  std::shared_ptr<SimulationBuild> first_of_commanded, first_of_refined;
  Snapshot snapshot;
  refined.write_snapshot(snapshot);
  reserve_for_refinement(snapshot);
  for (int t = 0; t < 1000; ++t) {
    commanded.advance(small_press(t));
    std::size_t allocations = allocation_count();
    refined.advance(small_press(t));
    refined.write_snapshot(snapshot);
    EXPECT_EQ(allocation_count(), allocations) << t;
    ASSERT_EQ(commanded.state_hash(), refined.state_hash()) << t;
    if (t != 350 && t != 600) continue;
    const RefineKnots wanted{0, Range<double>{0.6, 0.9}, Range<double>{0.025, t == 350 ? 0.04 : 0.035}};
    EXPECT_GT(commanded.tool_force_n().norm(), 0.0);
    if (!first_of_commanded) first_of_commanded = commanded.copy_build(BuildPart::mappings);
    ASSERT_TRUE(refiner.prepare(wanted).ok());
    allocations = allocation_count();
    std::shared_ptr<SimulationBuild>& replaced = refined.adopt(refiner);
    EXPECT_EQ(allocation_count(), allocations) << t;
    EXPECT_FALSE(refiner.is_prepared());
    if (!first_of_refined) first_of_refined = replaced;
    ASSERT_TRUE(commanded.apply(wanted).ok());
    ASSERT_EQ(commanded.state_hash(), refined.state_hash()) << t;
  }
  const auto tick_after_undo = [&](Simulation& simulation, std::shared_ptr<SimulationBuild> build) {
    simulation.exchange_build(std::move(build));
    EXPECT_TRUE(simulation.restore(start).ok());
    for (int t = 0; t < 10; ++t) simulation.advance(small_press(200 + t));
    return simulation.state_hash();
  };
  EXPECT_EQ(tick_after_undo(commanded, first_of_commanded), tick_after_undo(refined, first_of_refined));
}

TEST(Refiner, DoesWhatTheCommandDoesInAStroke) {
  expect_same_states(scene_of_small_press(ToolReach::whole));
}

TEST(Refiner, DoesWhatTheCommandDoesInALocalStroke) {
  expect_same_states(scene_of_small_press(ToolReach::local));
}

TEST(Refiner, DoesWhatTheCommandDoesBetweenTwoBodies) {
  expect_same_states(two_bodies());
}

TEST(Refiner, DoesWhatTheCommandDoesOnTheGround) {
  expect_same_states(scene_with_ground());
}

// A refinement that was prepared and not adopted, for example because of an undo, has no effect.
TEST(Refiner, ForgetsWhatWasNotAdopted) {
  Simulation simulation = simulate(scene_of_small_press(ToolReach::whole));
  Refiner refiner(simulation);
  const RefineKnots discarded{0, Range<double>{0.1, 0.4}, std::nullopt};
  const RefineKnots adopted{0, std::nullopt, Range<double>{0.02, 0.04}};
  const int rows = simulation.surface().net.rows, columns = simulation.surface().net.columns;
  ASSERT_TRUE(refiner.prepare(discarded).ok());
  ASSERT_TRUE(refiner.prepare(adopted).ok());
  simulation.adopt(refiner);
  EXPECT_EQ(simulation.surface().net.rows, rows);
  EXPECT_GT(simulation.surface().net.columns, columns);
}

TEST(Refiner, RefusesALargerNetThanADocumentTakes) {
  Simulation simulation = simulate(scene_of_small_press(ToolReach::whole));
  Refiner refiner(simulation);
  RefineKnots everything{0, std::nullopt, Range<double>{0.0, 0.06}};
  Status status;
  for (int k = 0; status.ok() && k < 10; ++k) {
    status = refiner.prepare(everything);
    if (status.ok()) simulation.adopt(refiner);
  }
  EXPECT_FALSE(status.ok());
  EXPECT_FALSE(refiner.is_prepared());
  EXPECT_LE(simulation.surface().net.columns, sculpted_control_point_count_range.high);
}

}  // namespace
}  // namespace spoonbill
