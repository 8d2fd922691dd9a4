// Tests fixed bodies: they have no lattice, carry other bodies, and turn as they are told.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/processor.h"
#include "engine/simulation/body_hold.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double g_m_per_s2 = 9.81;

// A soft block above a fixed plate.
Scene block_over_plate(double gap_m) {
  constexpr double friction = 0.5;
  Material soft = made_elastic(bundled_material("gelatin-10-1"));
  soft.friction = friction;
  Material hard = bundled_material("abs");
  hard.friction = friction;
  Body block = stock_body("block", BoxSize{{0.02, 0.01, 0.02}, 0.001}, {0.0, 0.005 + gap_m, 0.0}, soft, 300);
  Body plate = stock_body("plate", PlateSize{0.06, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0}, hard, 300);
  plate.kind = BodyKind::fixed;
  Scene scene = settling_scene({block, plate});
  scene.sculpting.gravity_m_per_s2 = {0.0, -g_m_per_s2, 0.0};
  scene.sculpting.free = true;
  return scene;
}

Vector3 find_centre_m(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& node : lattice.positions()) sum += node;
  return sum / lattice.mesh().node_count();
}

double largest_difference_m(const Surface& one, const Surface& other, const Pose& pose) {
  double largest = 0.0;
  for (int i = 0; i < one.net.rows; ++i) {
    for (int j = 0; j < one.net.columns; ++j) {
      const Vector3 moved = pose.position_m + pose.orientation * other.net.point(i, j);
      largest = std::max(largest, (one.net.point(i, j) - moved).norm());
    }
  }
  return largest;
}

TEST(FixedBody, CarriesAnotherBodyAndDoesNotMove) {
  Simulation simulation = make_simulation(block_over_plate(1e-5));
  const Surface before = simulation.surface(1);
  advance(simulation, 800, idle_tool());
  const double weight_n = g_m_per_s2 * simulation.lattice(0).mass_kg();
  const double pushed_n =
      mean_over(simulation, 200, idle_tool(), [&] { return simulation.contact_force_n(1).y(); });
  EXPECT_NEAR(-pushed_n, weight_n, 5e-3 * weight_n);
  const double carried_n =
      mean_over(simulation, 10, idle_tool(), [&] { return simulation.contact_force_n(0).y(); });
  EXPECT_NEAR(carried_n, weight_n, 5e-3 * weight_n);
  EXPECT_EQ(largest_difference_m(simulation.surface(1), before, {}), 0.0);
}

// Displacements of up to 4 cm are in single precision, which is 2e-9 m, and the fit of the control points
// adds up several of
// them.
constexpr double turn_tolerance_m = 1e-7;

TEST(FixedBody, TurnsAboutAnAxis) {
  Scene scene = block_over_plate(0.01);
  scene.sculpting.gravity_m_per_s2.setZero();
  Simulation simulation = make_simulation(scene);
  const Surface before = simulation.surface(1);
  TurnBody turn;
  turn.body = 1;
  turn.point_m = {0.01, 0.05, 0.0};
  turn.axis = Vector3(0.0, 3.0, 4.0) / 5.0;
  turn.angle_deg = -40.0;
  turn.speed_deg_per_s = 100.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  const int ticks = static_cast<int>(std::ceil(turn_duration_s(turn) / tick_s));
  const auto expected = [&](double angle_deg) {
    const Quaternion turned(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, turn.axis));
    return Pose{turn.point_m - turned * turn.point_m, turned};
  };
  for (int t = 1; t <= ticks; ++t) {
    EXPECT_TRUE(t == 1 || simulation.is_moving_bodies());
    const std::size_t allocated = allocation_count();
    simulation.advance(idle_tool());
    if (!assertions_allocate) {
      EXPECT_EQ(allocation_count(), allocated);
    }
    EXPECT_LT(
        largest_difference_m(simulation.surface(1), before, expected(turned_angle_deg(turn, t * tick_s))),
        turn_tolerance_m);
  }
  EXPECT_FALSE(simulation.is_moving_bodies());
  EXPECT_LT(largest_difference_m(simulation.surface(1), before, expected(turn.angle_deg)), turn_tolerance_m);
}

// Friction carries the block around with the plate that it lies on.
TEST(FixedBody, CarriesAlongWhatLiesOnIt) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene = block_over_plate(1e-5);
  scene.sculpting.is_critically_damped = false;
  scene.sculpting.real_time = true;
  Simulation simulation = make_simulation(scene);
  advance(simulation, 100, idle_tool());
  TurnBody turn;
  turn.body = 1;
  turn.point_m = {0.1, 0.0, 0.0};
  turn.axis = Vector3::UnitY();
  turn.angle_deg = 10.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  const Vector3 before = find_centre_m(simulation.lattice(0));
  advance(simulation, static_cast<int>(turn_duration_s(turn) / tick_s) + 50, idle_tool());
  const Quaternion turned(Eigen::AngleAxisd(turn.angle_deg * std::numbers::pi / 180.0, turn.axis));
  const Vector3 carried = turn.point_m + turned * (before - turn.point_m);
  EXPECT_GT((carried - before).norm(), 0.017);
  EXPECT_LT((find_centre_m(simulation.lattice(0)) - carried).norm(), 5e-4);
}

// A plate that turns about an axis far away lifts the block on it, which costs the weight times the height.
// It ends at rest, so that no other energy remains but that of its sag, which was there before.
TEST(FixedBody, DoesTheWorkThatLiftsABody) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene = block_over_plate(1e-5);
  scene.sculpting.is_critically_damped = false;
  scene.sculpting.real_time = true;
  scene.sculpting.drag_per_s = 0.0;
  Simulation simulation = make_simulation(scene);
  advance(simulation, 300, idle_tool());
  TurnBody turn;
  turn.body = 1;
  turn.point_m = {-0.2, 0.0, 0.0};
  turn.axis = Vector3::UnitZ();
  turn.angle_deg = 3.0;
  turn.speed_deg_per_s = 6.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  const double before_m = find_mass_centre(simulation.lattice(0)).position_m.y();
  double work_j = 0.0;
  for (int tick = 0; tick < static_cast<int>(turn_duration_s(turn) / tick_s) + 300; ++tick) {
    simulation.advance(idle_tool());
    work_j += simulation.contact_work_j(1);
    EXPECT_EQ(simulation.contact_work_j(0), 0.0);
  }
  const double rise_m = find_mass_centre(simulation.lattice(0)).position_m.y() - before_m;
  EXPECT_GT(rise_m, 0.01);
  const double lifted_j = g_m_per_s2 * simulation.lattice(0).mass_kg() * rise_m;
  EXPECT_NEAR(work_j, lifted_j, 0.02 * lifted_j);
}

TEST(FixedBody, SpeedsUpAndSlowsDownEvenly) {
  for (const double angle_deg : {0.5, 3.0, 40.0, -40.0}) {
    TurnBody turn;
    turn.angle_deg = angle_deg;
    const double end_s = turn_duration_s(turn);
    double last = 0.0, last_speed = 0.0;
    for (int t = 1; t <= 2000; ++t) {
      const double angle = turned_angle_deg(turn, t * 1e-3), speed = (angle - last) / 1e-3;
      EXPECT_LE(std::abs(speed), turn.speed_deg_per_s * (1.0 + 1e-9));
      EXPECT_LE(std::abs(speed - last_speed), turn.speed_deg_per_s / turn_ramp_s * 1.001e-3);
      last = angle;
      last_speed = speed;
    }
    EXPECT_EQ(turned_angle_deg(turn, end_s), angle_deg);
    EXPECT_NEAR(turned_angle_deg(turn, 0.5 * end_s), 0.5 * angle_deg, 1e-9);
    EXPECT_EQ(turned_angle_deg(turn, 0.0), 0.0);
  }
}

TEST(FixedBody, UndoRestoresItsPoseBitForBit) {
  Simulation simulation = make_simulation(block_over_plate(0.01));
  TurnBody turn;
  turn.body = 1;
  turn.angle_deg = 20.0;
  turn.speed_deg_per_s = 200.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  advance(simulation, 250, idle_tool());
  const ShapeState kept = simulation.shape();
  const Surface surface = simulation.surface(1);
  turn.angle_deg = -5.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  advance(simulation, 100, idle_tool());
  EXPECT_GT(largest_difference_m(simulation.surface(1), surface, {}), 1e-5);
  ASSERT_TRUE(simulation.restore(kept).ok());
  EXPECT_TRUE(simulation.shape() == kept);
  EXPECT_FALSE(simulation.is_moving_bodies());
  advance(simulation, 10, idle_tool());
  EXPECT_EQ(largest_difference_m(simulation.surface(1), surface, {}), 0.0);
}

// A body that is lowered descends level at its speed, and is let go when contacts bear its weight.
TEST(LoweredBody, DescendsUntilAnotherBodyBearsIt) {
  Simulation simulation = make_simulation(block_over_plate(2e-4));
  ASSERT_TRUE(simulation.apply(LowerBody{0, 0.002}).ok());
  const auto height_m = [&] { return find_centre_m(simulation.lattice(0)).y(); };
  const double start_m = height_m();
  advance(simulation, 50, idle_tool());
  EXPECT_NEAR(start_m - height_m(), 50 * tick_s * 0.002, 2e-6);
  int ticks = 50;
  while (simulation.is_moving_bodies() && ticks < 2000) {
    simulation.advance(idle_tool());
    ++ticks;
  }
  EXPECT_LT(ticks, 500);
  // The descent ends without a jolt: the block hardly moves from there.
  const double released_m = height_m();
  advance(simulation, 300, idle_tool());
  EXPECT_NEAR(height_m(), released_m, 1e-4);
}

// A body that is lowered and then fixed stays where it is.
TEST(LoweredBody, IsLoweredNoMoreOnceItIsFixed) {
  Simulation simulation = make_simulation(block_over_plate(0.01));
  ASSERT_TRUE(simulation.apply(LowerBody{0, 0.01}).ok());
  advance(simulation, 5, idle_tool());
  ASSERT_TRUE(simulation.apply(PlacePlane{{Vector3(0.0, 0.1, 0.0), Vector3::UnitY()}}).ok());
  EXPECT_FALSE(simulation.is_moving_bodies());
  const Vector3 before = find_centre_m(simulation.lattice(0));
  advance(simulation, 20, idle_tool());
  EXPECT_EQ(find_centre_m(simulation.lattice(0)), before);
}

// All edges of an open sheet turn with it.
TEST(FixedBody, TurnsAShell) {
  Scene scene = block_over_plate(0.01);
  scene.sculpting.gravity_m_per_s2.setZero();
  Body& shell = scene.bodies[1];
  shell.surface = stock_surface(SheetSize{0.06, 0.04}, {0.0, -0.01, 0.0});
  shell.shell_thickness_m = 0.002;
  Simulation simulation = make_simulation(scene);
  const Surface before = simulation.surface(1);
  TurnBody turn;
  turn.body = 1;
  turn.axis = Vector3::UnitY();
  turn.angle_deg = 90.0;
  turn.speed_deg_per_s = 360.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  advance(simulation, static_cast<int>(turn_duration_s(turn) / tick_s) + 2, idle_tool());
  const Quaternion turned(Eigen::AngleAxisd(std::numbers::pi / 2.0, turn.axis));
  EXPECT_LT(largest_difference_m(simulation.surface(1), before, {Vector3::Zero(), turned}), turn_tolerance_m);
}

// A stiff body, which is stepped implicitly, rests on a fixed one.
TEST(FixedBody, CarriesAStiffBody) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene = block_over_plate(1e-5);
  scene.bodies[0].material = made_elastic(bundled_material("abs"));
  scene.bodies[0].material.friction = 0.5;
  Simulation simulation = make_simulation(scene);
  advance(simulation, 600, idle_tool());
  const double weight_n = g_m_per_s2 * simulation.lattice(0).mass_kg();
  const double carried_n =
      mean_over(simulation, 200, idle_tool(), [&] { return simulation.contact_force_n(0).y(); });
  EXPECT_NEAR(carried_n, weight_n, 5e-3 * weight_n);
  EXPECT_LT(simulation.largest_overlap_m(), 5e-5);
}

TEST(FixedBody, RefusesWhatItCannotDo) {
  Simulation simulation = make_simulation(block_over_plate(0.01));
  TurnBody turn;
  EXPECT_EQ(simulation.apply(turn).error().code, ErrorCode::inconsistent);
  turn.body = 1;
  turn.speed_deg_per_s = 0.0;
  EXPECT_EQ(simulation.apply(turn).error().code, ErrorCode::out_of_range);
  turn.body = 2;
  EXPECT_EQ(simulation.apply(turn).error().code, ErrorCode::out_of_range);
  EXPECT_EQ(simulation.apply(LowerBody{1, 0.01}).error().code, ErrorCode::inconsistent);
  EXPECT_EQ(simulation.apply(LowerBody{0, -0.01}).error().code, ErrorCode::out_of_range);
  Scene loaded = block_over_plate(0.01);
  loaded.bodies[1].supports = {{end_region(loaded.bodies[1].surface, 0, true, 0.2), {}}};
  const auto refused = Simulation::make(loaded, InstructionSet::baseline);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().field, "supports");
  Scene point = block_over_plate(0.01);
  for (std::vector<double>* axis :
       {&point.bodies[1].surface.net.x, &point.bodies[1].surface.net.y, &point.bodies[1].surface.net.z}) {
    std::fill(axis->begin(), axis->end(), 0.0);
  }
  EXPECT_FALSE(Simulation::make(point, InstructionSet::baseline).ok());
  Scene open = block_over_plate(0.01);
  open.bodies[1].surface = stock_surface(SheetSize{0.06, 0.04});
  EXPECT_FALSE(Simulation::make(open, InstructionSet::baseline).ok());
}

}  // namespace
}  // namespace spoonbill
