// Tests that smoothing removes bumps and dents, keeps the form, and causes no force.
#include "engine/simulation/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice_solver.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

Scene smoothed_by(Scene scene, double radius_m) {
  scene.tool.action = ToolAction::smooth;
  scene.tool.radius_m = radius_m;
  return scene;
}

// Returns the point between u = low and u = high at which the surface crosses the plane z = 0.
Vector3 middle_line(const Surface& surface, double v, double low, double high) {
  const bool rises = evaluate(surface, low, v).position_m.z() < evaluate(surface, high, v).position_m.z();
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    ((evaluate(surface, middle, v).position_m.z() < 0.0) == rises ? low : high) = middle;
  }
  return evaluate(surface, low, v).position_m;
}
Vector3 top(const Surface& surface, double v) {
  return middle_line(surface, v, 0.6, 0.9);
}
double thickness_m(const Surface& surface, double v) {
  return (top(surface, v) - middle_line(surface, v, 0.1, 0.4)).norm();
}

// Returns the largest loss of the handle's thickness since the rest shape, within 7 mm of v; a bend does not
// count.
double dent_m(const Simulation& simulation, double v) {
  double deepest = 0.0;
  for (int i = -14; i <= 14; ++i) {
    const double at = v + 0.0005 * i;
    deepest = std::max(
        deepest, thickness_m(small_handle().bodies[0].surface, at) - thickness_m(simulation.surface(), at));
  }
  return deepest;
}

// Returns the largest gain of the handle's thickness beside a dent at v.
double rim_height_m(const Simulation& simulation, double v) {
  double highest = 0.0;
  for (int i = -24; i <= 24; ++i) {
    const double at = v + 0.0005 * i;
    highest = std::max(
        highest, thickness_m(simulation.surface(), at) - thickness_m(small_handle().bodies[0].surface, at));
  }
  return highest;
}

// Returns a handle with a dent that a point tool has pressed while both ends were fixed. Afterwards only the
// left end stays fixed.
Simulation dented(double v) {
  Scene scene = small_handle();
  scene.tool.kind = ToolKind::point;
  scene.tool.substeps = 1;
  scene.bodies[0].material.flow_rate_per_s = 50.0;
  const FixingPlane left{Vector3(0.012, 0, 0), Vector3::UnitX()};
  scene.planes = {left, {Vector3(0.048, 0, 0), -Vector3::UnitX()}};
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 400; ++tick) simulation.advance(above(v, 0.004 - 2e-5 * tick));
  for (int tick = 0; tick < 600; ++tick) simulation.advance(above(v, 0.02));
  EXPECT_TRUE(simulation.apply(RemovePlanes{}).ok());
  EXPECT_TRUE(simulation.apply(PlacePlane{left}).ok());
  for (int tick = 0; tick < 1000; ++tick) simulation.advance(above(v, 0.02));
  return simulation;
}

void choose(Simulation& simulation, ToolAction action, double radius_m) {
  Tool tool = simulation.scene().tool;
  tool.kind = ToolKind::sphere;
  tool.action = action;
  tool.radius_m = radius_m;
  ASSERT_TRUE(simulation.apply(SetTool{tool}).ok());
}

// Returns the input of a hand at a position over the handle's centre line. A spring couples the tool to the
// hand.
ToolInput resting(double x_m, double y_m) {
  ToolInput input = above(x_m, y_m);
  input.coupling_n_per_m = 400.0;
  return input;
}

TEST(Smoothing, TakesADentOutAndLeavesTheRestInPlace) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const double v = 0.03, radius = 0.008;
  Simulation simulation = dented(v);
  const double before = dent_m(simulation, v);
  ASSERT_GT(before, 3e-4);
  const Surface dent = simulation.surface();
  const Vector3 tip = top(simulation.surface(), 0.058);
  choose(simulation, ToolAction::smooth, radius);
  for (int tick = 0; tick < 3000; ++tick) {
    const double x = v + 0.006 * std::sin(tick * 2.0 * std::numbers::pi / 1000.0);
    simulation.advance(resting(x, top(simulation.surface(), x).y() + radius - 0.001));
  }
  EXPECT_LT(dent_m(simulation, v), 0.35 * before);
  for (int tick = 0; tick < 1000; ++tick) simulation.advance(resting(v, 0.03));
  EXPECT_LT(dent_m(simulation, v), 0.35 * before) << "it springs back";
  // The handle bends by no more than a tenth of the dent.
  EXPECT_LT((top(simulation.surface(), 0.058) - tip).norm(), 0.1 * before);
  EXPECT_EQ((top(simulation.surface(), 0.010) - top(dent, 0.010)).norm(), 0.0);
}

TEST(Smoothing, LowersTheRimOfADentAndDoesNotDeepenItsFloor) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const double v = 0.03, radius = 0.008;
  Simulation simulation = dented(v);
  const double rim = rim_height_m(simulation, v), floor = dent_m(simulation, v);
  ASSERT_GT(rim, 2e-5) << "the material that a press displaces rises beside it";
  choose(simulation, ToolAction::smooth, radius);
  for (int tick = 0; tick < 1500; ++tick) {
    const double x = v + 0.006 * std::sin(tick * 2.0 * std::numbers::pi / 500.0);
    simulation.advance(resting(x, top(simulation.surface(), x).y() + radius - 0.001));
    // Rounding aside, the floor is never deeper than it was.
    if (tick % 100 != 0) continue;
    ASSERT_LT(dent_m(simulation, v), 1.001 * floor) << tick;
  }
  EXPECT_LT(rim_height_m(simulation, v), 0.9 * rim);
  EXPECT_LT(dent_m(simulation, v), floor);
}

TEST(Smoothing, TheBodyIsAWallToTheToolAndARodStaysARod) {
  Scene scene = smoothed_by(small_handle(), 0.006);
  ControlNet& net = scene.bodies[0].surface.net;
  for (int i = 0; i < net.rows; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / net.rows;
    for (int j = 0; j < net.columns; ++j) {
      const Vector3 point = net.point(i, j);
      const double radius = 0.004 * net.point(0, j).z() / net.point(0, net.columns / 2).z();
      net.set_point(i, j, {point.x(), -radius * std::sin(angle), radius * std::cos(angle)});
    }
  }
  Simulation simulation = simulate(scene);
  const Surface before = simulation.surface();
  const double surface_y = top(before, 0.03).y();
  Reaction reaction;
  for (int tick = 0; tick < 2000; ++tick) reaction = simulation.advance(resting(0.03, surface_y + 0.005));
  EXPECT_TRUE(reaction.touching);
  // The force is that of a spring of 400 N/m stretched by 1 mm, plus the part that keeps the tool off the
  // curved wall.
  EXPECT_NEAR(reaction.force_n.y(), 0.4, 0.03);
  double largest = 0.0;
  for (int a = 0; a < 24; ++a) {
    for (int b = 0; b <= 40; ++b) {
      const double u = a / 24.0, v = 0.01 + 0.001 * b;
      largest = std::max(
          largest,
          (evaluate(simulation.surface(), u, v).position_m - evaluate(before, u, v).position_m).norm());
    }
  }
  // Twelve control points approximate a circle to a hundredth of its radius, and smoothing may remove that
  // much.
  EXPECT_LT(largest, 0.01 * 0.004);
}

class Reform : public ::testing::Test {
 protected:
  Reform()
      : lattice_(SpringLattice::make(box_mesh({0.012, 0.012, 0.03}, {5, 5, 11}), soft_clay(),
                                     InstructionSet::baseline)
                     .value()) {}
  // Returns a material so soft that a tick takes a single substep.
  static Material soft_clay() {
    Material material = small_handle().bodies[0].material;
    material.youngs_modulus_pa = 100.0;
    return material;
  }
  SpringLattice lattice_;
};

TEST_F(Reform, StrainsNothing) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const int node = random.integer(0, lattice_.mesh().node_count() - 1);
    lattice_.reform(node, 2e-4 * Vector3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                                         random.uniform(-1.0, 1.0)));
  }
  std::vector<Vector3> before;
  for (int n = 0; n < lattice_.mesh().node_count(); ++n) before.push_back(lattice_.position(n));
  for (std::uint64_t tick = 0; tick < 500; ++tick) relax(std::array{RelaxedLattice{&lattice_}}, {tick}, {});
  double largest = 0.0;
  for (int n = 0; n < lattice_.mesh().node_count(); ++n) {
    largest = std::max(largest, (lattice_.position(n) - before[static_cast<std::size_t>(n)]).norm());
  }
  // Rounding causes strains of 1e-6, which add up to 3e-8 m along the block of 3 cm.
  EXPECT_LT(largest, 1e-6);
}

TEST_F(Reform, RefusesToCrushACellAndThenChangesNothing) {
  const int inner = lattice_.mesh().index(2, 2, 5);
  const std::vector<float> before = lattice_.shape();
  EXPECT_FALSE(lattice_.reform(inner, {0.0, 0.0, 0.0029}));
  EXPECT_EQ(lattice_.shape(), before);
  EXPECT_TRUE(lattice_.reform(inner, {0.0, 0.0, 0.001}));
  EXPECT_NE(lattice_.shape(), before);
}

TEST_F(Reform, IsUndoneWithTheShape) {
  const std::vector<float> before = lattice_.shape();
  const double volume = lattice_.volume_m3();
  ASSERT_TRUE(lattice_.reform(0, {-0.001, -0.001, -0.001}));
  EXPECT_GT(lattice_.volume_m3(), volume);
  ASSERT_TRUE(lattice_.set_shape(before));
  for (std::uint64_t tick = 0; tick < 20; ++tick) relax(std::array{RelaxedLattice{&lattice_}}, {tick}, {});
  EXPECT_EQ(lattice_.shape(), before);
}

}  // namespace
}  // namespace spoonbill
