// Tests that a stroke of local reach shapes the material near the touched point to the asked depth, and that
// everything else keeps its place.
#include "engine/simulation/local_stroke.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/evaluate.h"
#include "tests/engine/allocations.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

Scene local_scene(ToolAction action, double radius_m) {
  Scene scene = small_handle();
  scene.bodies[0].lattice.node_budget = 1200;
  scene.tool.action = action;
  scene.tool.radius_m = radius_m;
  scene.tool.reach = ToolReach::local;
  return scene;
}

constexpr double place_m = 0.03;

// Height of the top of the handle at rest, where the tools touch it.
const double top_m = [] {
  double highest_m = 0.0;
  const Surface rest = small_handle().bodies[0].surface;
  for (int a = 0; a < 96; ++a) highest_m = std::max(highest_m, position(rest, a / 96.0, place_m).y());
  return highest_m;
}();

// Presses the top of the handle by `depth_m`, holds, and moves away.
double press(Simulation& simulation, double depth_m) {
  const double radius_m = simulation.scene().tool.radius_m;
  double felt_n = 0.0;
  for (int t = 0; t <= 300; ++t) {
    felt_n = std::max(
        felt_n, simulation.advance(above(place_m, top_m + radius_m + 0.001 - (depth_m + 0.001) * t / 300))
                    .force_n.norm());
  }
  for (int t = 0; t < 400; ++t) simulation.advance(above(place_m, top_m + radius_m - depth_m));
  for (int t = 0; t < 100; ++t) simulation.advance(far_away);
  return felt_n;
}

// Grips the top of the handle, pulls it up by `height_m`, holds, and lets go.
void pull(Simulation& simulation, double height_m) {
  const double radius_m = simulation.scene().tool.radius_m;
  for (int t = 0; t <= 100; ++t) simulation.advance(above(place_m, top_m + radius_m * (1.0 - t / 100.0)));
  for (int t = 0; t <= 300; ++t) simulation.advance(above(place_m, top_m + height_m * t / 300.0, true));
  for (int t = 0; t < 400; ++t) simulation.advance(above(place_m, top_m + height_m, true));
  for (int t = 0; t < 100; ++t) simulation.advance(far_away);
}

// How far points of the surface have moved outward, and how far those on the other side have moved at all.
struct Moved {
  double outward_m = 0.0, inward_m = 0.0, far_side_m = 0.0, beyond_m = 0.0;
};

Moved measure(const Simulation& simulation, double radius_m) {
  const Surface rest = small_handle().bodies[0].surface;
  Moved moved;
  for (int a = 0; a < 96; ++a) {
    for (int b = 0; b <= 240; ++b) {
      const double u = a / 96.0, v = 0.06 * b / 240;
      const Vector3 start_m = evaluate(rest, u, v).position_m;
      const Vector3 normal = unit_normal(rest, u, v);
      const Vector3 move_m = evaluate(simulation.surface(), u, v).position_m - start_m;
      moved.outward_m = std::max(moved.outward_m, move_m.dot(normal));
      moved.inward_m = std::max(moved.inward_m, -move_m.dot(normal));
      if (normal.y() < -0.5) moved.far_side_m = std::max(moved.far_side_m, move_m.norm());
      if (std::abs(start_m.x() - place_m) > radius_m)
        moved.beyond_m = std::max(moved.beyond_m, move_m.norm());
    }
  }
  return moved;
}

// Lets the simulation refine its surface until it asks for no more.
void refine(Simulation& simulation) {
  for (int t = 0; t < 500; ++t) {
    simulation.advance(far_away);
    if (!simulation.wanted_refinement()) continue;
    ASSERT_TRUE(simulation.apply(*simulation.wanted_refinement()).ok());
  }
}

TEST(LocalStroke, DentsToTheDepthOfTheHand) {
  Simulation simulation = simulate(local_scene(ToolAction::push, 0.006));
  press(simulation, 0.0012);
  refine(simulation);
  const Moved moved = measure(simulation, 1.5 * 0.6 * 0.006 + 0.003);
  EXPECT_NEAR(moved.inward_m, 0.0012, 0.1 * 0.0012);
  EXPECT_LT(moved.outward_m, 1.5e-4);
  EXPECT_LT(moved.far_side_m, 5e-5);
  EXPECT_LT(moved.beyond_m, 1e-4);
}

TEST(LocalStroke, RaisesABulgeToTheHeightOfTheHand) {
  Simulation simulation = simulate(local_scene(ToolAction::pull, 0.004));
  pull(simulation, 0.0015);
  refine(simulation);
  const Moved moved = measure(simulation, 1.5 * 0.004 + 0.003);
  EXPECT_NEAR(moved.outward_m, 0.0015, 0.15 * 0.0015);
  EXPECT_LT(moved.inward_m, 1.5e-4);
  EXPECT_LT(moved.far_side_m, 5e-5);
  EXPECT_LT(moved.beyond_m, 1e-4);
}

// The far side keeps its place however deep the hand goes; the material compresses as far as it can.
TEST(LocalStroke, HoldsTheFarSideAgainstTooDeepAStroke) {
  Simulation simulation = simulate(local_scene(ToolAction::push, 0.006));
  press(simulation, 0.006);
  refine(simulation);
  const Moved moved = measure(simulation, 0.02);
  EXPECT_LT(moved.far_side_m, 1e-4);
  EXPECT_GT(moved.inward_m, 0.0012);
  EXPECT_GT(smallest_jacobian_ratio(simulation.lattice().mesh().cell(0, 0, 0)), 0.0);
  const SpringLattice& lattice = simulation.lattice();
  for (int n = 0; n < lattice.mesh().node_count(); ++n) ASSERT_TRUE(lattice.position(n).allFinite());
}

// The material has its new place as its rest shape: without a plane and without drag it stays there.
TEST(LocalStroke, LeavesNothingThatSpringsBack) {
  Scene scene = local_scene(ToolAction::push, 0.006);
  scene.bodies[0].material.plastic = false;
  Simulation simulation = simulate(scene);
  EXPECT_GT(press(simulation, 0.001), 1e-3) << "the hand feels the stroke";
  const Moved soon = measure(simulation, 0.02);
  for (int t = 0; t < 1500; ++t) simulation.advance(far_away);
  const Moved late = measure(simulation, 0.02);
  EXPECT_NEAR(late.inward_m, soon.inward_m, 0.02 * soon.inward_m);
  EXPECT_NEAR(simulation.lattice().fastest_m_per_s(), 0.0, 1e-5);
}

// A stiff body is moved by an implicit solver, which has a rest shape of its own.
TEST(LocalStroke, IsUndoneOnAStiffBodyToo) {
  Scene scene = local_scene(ToolAction::push, 0.006);
  Material& material = scene.bodies[0].material;
  material.plastic = false;
  material.youngs_modulus_pa = 1e9;
  scene.planes = {{Vector3(0.01, 0, 0), Vector3::UnitX()}};
  Simulation simulation = simulate(scene);
  simulation.advance(far_away);
  const ShapeState before = simulation.shape();
  press(simulation, 0.001);
  const Moved shaped = measure(simulation, 0.02);
  EXPECT_GT(shaped.inward_m, 5e-4);
  const ShapeState after = simulation.shape();
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(simulation.restore(before).ok());
    for (int t = 0; t < 50; ++t) simulation.advance(far_away);
    EXPECT_LT(measure(simulation, 0.02).inward_m, 1e-5) << k;
    ASSERT_TRUE(simulation.restore(after).ok());
    for (int t = 0; t < 50; ++t) simulation.advance(far_away);
    EXPECT_NEAR(measure(simulation, 0.02).inward_m, shaped.inward_m, 5e-5) << k;
  }
}

TEST(LocalStroke, HasTheRadiusThatIsAsked) {
  double narrow_m = 0.0;
  for (const double radius_m : {0.004, 0.008}) {
    Scene scene = local_scene(ToolAction::push, 0.002);
    scene.tool.local_radius_m = radius_m;
    Simulation simulation = simulate(scene);
    press(simulation, 0.001);
    refine(simulation);
    // Half of the depth is reached at 0.54 of the radius.
    double widest_m = 0.0;
    const Surface rest = small_handle().bodies[0].surface;
    double top_u = 0.0;
    for (int a = 0; a < 96; ++a) {
      if (position(rest, a / 96.0, place_m).y() > position(rest, top_u, place_m).y()) top_u = a / 96.0;
    }
    const double depth_m = measure(simulation, 0.02).inward_m;
    for (int b = 0; b <= 600; ++b) {
      const double v = 0.06 * b / 600;
      const Vector3 start_m = evaluate(rest, top_u, v).position_m;
      const double down_m = (start_m - evaluate(simulation.surface(), top_u, v).position_m).y();
      if (down_m > 0.5 * depth_m) widest_m = std::max(widest_m, std::abs(start_m.x() - place_m));
    }
    EXPECT_NEAR(widest_m, 0.54 * radius_m, 0.25 * radius_m) << radius_m;
    EXPECT_GT(widest_m, narrow_m);
    narrow_m = widest_m;
  }
}

TEST(LocalStroke, AllocatesNothing) {
  Simulation simulation = simulate(local_scene(ToolAction::push, 0.006));
  simulation.advance(far_away);
  const std::size_t before = allocation_count();
  press(simulation, 0.001);
  EXPECT_EQ(allocation_count(), before);
}

TEST(LocalStroke, IsTheSameOnEveryInstructionSet) {
  std::uint64_t hash = 0;
  for (const InstructionSet set : available_instruction_sets()) {
    Simulation simulation = simulate(local_scene(ToolAction::push, 0.006), set);
    press(simulation, 0.001);
    if (hash == 0) hash = simulation.state_hash();
    EXPECT_EQ(simulation.state_hash(), hash);
  }
}

}  // namespace
}  // namespace spoonbill
