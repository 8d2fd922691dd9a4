#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/evaluate.h"
#include "engine/scene/scene.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

TEST(Tool, SymmetryMirrorsTheStroke) {
  for (const bool symmetric : {true, false}) {
    Scene scene = small_handle();
    scene.tool.substeps = 1;
    scene.bodies[0].material.flow_rate_per_s = 50.0;
    scene.sculpting.free = !symmetric;  // a free body turns under a one-sided stroke
    scene.tool.radius_m = 0.0015;
    scene.symmetry.on = symmetric;  // mirrors at z = 0
    Simulation simulation = simulate(scene);
    const Surface before = simulation.surface();
    Pose hand;
    Reaction reaction;
    for (int tick = 0; tick < 250; ++tick) {
      hand.position_m = Vector3(0.03, 0.0042 - 8e-6 * tick, 0.003);
      reaction = simulation.advance({hand, false, 0.0});
    }
    EXPECT_TRUE(reaction.touching);
    EXPECT_EQ(reaction.mirror_touching, symmetric);
    // The basis function of the control point at the top starts at u = 0.75 and has its maximum two of the
    // twelve spans later. Points at equal distances from this maximum are mirror images.
    const double top = 0.75 + 2.0 / 12.0;
    const auto dent = [&](double u) {
      return (evaluate(before, u, 0.03).position_m - evaluate(simulation.surface(), u, 0.03).position_m).y();
    };
    const double left = dent(top - 0.09), right = dent(top + 0.09 - 1.0);
    ASSERT_GT(std::max(left, right), 2e-4);
    // The two tools alternate within a substep, so that the sides agree closely but not bit for bit.
    if (symmetric) {
      EXPECT_NEAR(left, right, 0.03 * std::max(left, right));
    } else {
      EXPECT_GT(std::abs(left - right), 0.3 * std::max(left, right));
    }
  }
}

TEST(Symmetry, MirrorsPosesAsAMirrorDoes) {
  const Symmetry plane{true, Vector3(0.01, 0, 0), Vector3(1, 2, -2) / 3.0};
  const Pose pose{Vector3(0.02, -0.01, 0.03), Quaternion(0.5, -0.1, 0.7, 0.5).normalized()};
  const Pose mirror = mirror_pose(plane, pose);
  const Vector3 offset(0.001, 0.002, -0.003);
  // A mirrored tool carries the mirrored offset to its mirror image: R' (M d) = M (R d), where M mirrors the
  // offset d, R is the tool's rotation and R' that of the mirrored tool.
  const auto reflect = [&](const Vector3& d) {
    return Vector3(d - 2.0 * plane.normal.dot(d) * plane.normal);
  };
  EXPECT_LT((mirror.orientation * reflect(offset) - reflect(pose.orientation * offset)).norm(), 1e-15);
  EXPECT_LT((mirror_point(plane, mirror.position_m) - pose.position_m).norm(), 1e-15);
}

TEST(Tool, ALiftedToolActsOnlyAfterItHasLeft) {
  Scene scene = small_handle();
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  Simulation simulation = simulate(scene);
  const double inside = 0.006;
  for (int tick = 0; tick < 50; ++tick) simulation.advance(above(0.03, 0.009 - 6e-5 * tick));
  ASSERT_TRUE(simulation.apply(LiftTool{}));
  Reaction reaction;
  for (int tick = 0; tick < 20; ++tick) {
    reaction = simulation.advance(above(0.03, inside));
    ASSERT_FALSE(reaction.touching) << tick;
  }
  for (int tick = 0; tick < 30; ++tick) simulation.advance(above(0.03, 0.02));
  for (int tick = 0; tick < 120; ++tick) reaction = simulation.advance(above(0.03, 0.009 - 6e-5 * tick));
  EXPECT_TRUE(reaction.touching);
}

TEST(Tool, ALiftedToolThatHoversJustAboveActsOnTheNextPress) {
  Scene scene = small_handle();
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  Simulation simulation = simulate(scene);
  ToolInput input = above(0.03, 0.02);
  for (int tick = 0; tick < 5; ++tick) simulation.advance(input);
  double surface = 0.02;
  while (!simulation.advance(above(0.03, surface)).touching && surface > 0.0) surface -= 1e-4;
  ASSERT_TRUE(simulation.apply(LiftTool{}));
  input = above(0.03, surface + 5e-4);
  input.hovering = true;
  for (int tick = 0; tick < 20; ++tick) ASSERT_FALSE(simulation.advance(input).touching);
  bool touching = false;
  for (int tick = 0; tick < 30; ++tick) touching |= simulation.advance(above(0.03, surface - 5e-4)).touching;
  EXPECT_TRUE(touching);
}

TEST(Tool, AHoveringToolTouchesNothingUntilItIsOutside) {
  Scene scene = small_handle();
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  Simulation simulation = simulate(scene);
  const auto hover = [&](double y, bool hovering) {
    ToolInput input = above(0.03, y);
    input.hovering = hovering;
    return simulation.advance(input).touching;
  };
  // The tool passes through the surface.
  for (int tick = 0; tick < 100; ++tick) ASSERT_FALSE(hover(0.02 - 4e-4 * tick, true));
  for (int tick = 0; tick < 20; ++tick) ASSERT_FALSE(hover(0.0, true));
  for (int tick = 0; tick < 20; ++tick) ASSERT_FALSE(hover(0.0, false));  // the tool is still inside
  for (int tick = 0; tick < 50; ++tick) hover(0.02, false);
  bool touching = false;
  for (int tick = 0; tick < 60; ++tick) touching = hover(0.009 - 6e-5 * tick, false);
  EXPECT_TRUE(touching);
}

TEST(Tool, AResetProxyDoesNotSweepTheWayBetween) {
  Simulation simulation = simulate(small_handle());
  simulation.advance(above(0.03, 0.03));
  ASSERT_TRUE(simulation.apply(ResetProxy{}));
  // The tool moves straight through the handle to the other side in one tick.
  const Reaction reaction = simulation.advance(above(0.03, -0.03));
  EXPECT_FALSE(reaction.touching);
  EXPECT_NEAR(reaction.proxy.position_m.y(), -0.03, 1e-9);
}

// A pressed tool that holds takes the touched point along sideways. One that slides, or is not pressed,
// leaves it.
TEST(Tool, HoldsWhatItTouchesWhilePressed) {
  const auto dragged_m = [](ToolGlide sideways, bool pressed) {
    Scene scene = small_handle();
    scene.bodies[0].material.plastic = false;
    scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
    scene.tool.sideways = sideways;
    Simulation simulation = simulate(scene);
    const auto tip_m = [&] { return evaluate(simulation.surface(), 0.9, 0.05).position_m.z(); };
    const double before_m = tip_m();
    for (int tick = 0; tick < 600; ++tick) {
      const double down_m = 1e-3 * std::min(1.0, tick / 200.0);
      const double aside_m = 3e-3 * std::clamp((tick - 200) / 300.0, 0.0, 1.0);
      ToolInput input = above(0.05, 0.0026 + scene.tool.radius_m - down_m, pressed);
      input.pose.position_m.z() += aside_m;
      input.coupling_n_per_m = 1000.0 / 60.0;  // a hand of 1000 N/m that feels the force 60 times as strong
      simulation.advance(input);
    }
    return tip_m() - before_m;
  };
  const double held_m = dragged_m(ToolGlide::hold, true);
  EXPECT_GT(held_m, 0.8 * 3e-3);
  EXPECT_LT(dragged_m(ToolGlide::slide, true), 0.3 * held_m);
  EXPECT_LT(dragged_m(ToolGlide::hold, false), 0.3 * held_m);
}

}  // namespace
}  // namespace spoonbill
