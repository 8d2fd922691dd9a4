// Tests motions through waypoints: the path itself, and bodies that follow one.
#include "engine/scene/body_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "engine/scene/place_body.h"
#include "engine/simulation/body_hold.h"
#include "engine/trial/trial.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

constexpr double rounding_m = 1e-12;  // of double precision, for paths of decimetres

// Lifts a point by 50 mm, carries it 80 mm aside while it turns, holds it there, and puts it back.
BodyMotion lift_and_carry() {
  return {{0.01, 0.02, 0.0},
          {{0.3, {0.0, 0.05, 0.0}, Vector3::UnitX(), 0.0},
           {0.8, {0.08, 0.05, 0.0}, Vector3::UnitZ(), 60.0},
           {1.2, {0.08, 0.05, 0.0}, Vector3::UnitZ(), 60.0},
           {2.0, Vector3::Zero(), Vector3::UnitX(), 0.0}}};
}

// A fixed plate whose top is at the height 0.
Body make_plate(const BodyMotion& motion) {
  Material hard = bundled_material("abs");
  hard.friction = 0.5;
  Body plate = stock_body("plate", PlateSize{0.08, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0}, hard, 300);
  plate.kind = BodyKind::fixed;
  plate.motion = motion;
  return plate;
}

Quaternion turn_by(const Vector3& axis, double angle_deg) {
  return Quaternion(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, axis));
}

Vector3 image_m(const Pose& pose, const Vector3& point_m) {
  return pose.position_m + pose.orientation * point_m;
}

TEST(MotionPath, PassesItsWaypoints) {
  const BodyMotion motion = lift_and_carry();
  const MotionPath path(motion);
  EXPECT_EQ(path.duration_s(), 2.0);
  EXPECT_LT((image_m(path.at(0.0, {}), motion.point_m) - motion.point_m).norm(), rounding_m);
  for (const Waypoint& waypoint : motion.waypoints) {
    const Pose pose = path.at(waypoint.time_s, {});
    EXPECT_LT((image_m(pose, motion.point_m) - motion.point_m - waypoint.moved_m).norm(), rounding_m);
    EXPECT_LT(pose.orientation.angularDistance(turn_by(waypoint.axis, waypoint.angle_deg)), 1e-7);
  }
  EXPECT_LT(path.at(5.0, {}).position_m.norm(), rounding_m);  // it stays at the last waypoint
}

// A cubic between two points of rest: s (3 t^2 - 2 t^3).
TEST(MotionPath, ASingleStepIsACubic) {
  const MotionPath path({Vector3::Zero(), {{0.5, {0.2, 0.0, 0.0}}}});
  for (int step = 0; step <= 10; ++step) {
    const double t = step / 10.0;
    EXPECT_NEAR(path.at(0.5 * t, {}).position_m.x(), 0.2 * (3.0 * t * t - 2.0 * t * t * t), rounding_m);
  }
}

// Velocities do not jump, and the body rests between two equal waypoints and at both ends.
TEST(MotionPath, IsSmoothAndDoesNotOvershoot) {
  const BodyMotion motion = lift_and_carry();
  const MotionPath path(motion);
  constexpr double step_s = 1e-4;
  Vector3 last_m_per_s = Vector3::Zero();
  for (int step = 0; step < 20000; ++step) {
    const Pose pose = path.at(step * step_s, {}), next = path.at((step + 1) * step_s, {});
    const Vector3 from = image_m(pose, motion.point_m), to = image_m(next, motion.point_m);
    const Vector3 m_per_s = (to - from) / step_s;
    // The curvature of a cubic of 8 cm in 0.4 s is below 12 h / T^2.
    EXPECT_LT((m_per_s - last_m_per_s).norm(), 10.0 * step_s);
    last_m_per_s = m_per_s;
    EXPECT_GT(to.x(), 0.01 - rounding_m);
    EXPECT_LT(to.x(), 0.09 + rounding_m);
    EXPECT_LT(to.y(), 0.07 + rounding_m);
    if (step >= 8000 && step < 12000) {
      EXPECT_LT(m_per_s.norm(), 1e-8);
      EXPECT_LT(pose.orientation.angularDistance(next.orientation), 1e-7);
    }
  }
  EXPECT_LT(last_m_per_s.norm(), 1e-3);
}

// A body that a turn has moved already takes the point of its motion with it.
TEST(MotionPath, StartsWhereTheBodyIs) {
  const BodyMotion motion = lift_and_carry();
  const Pose start{{0.3, -0.1, 0.2}, turn_by(Vector3::UnitY(), 40.0)};
  const Pose end = MotionPath(motion).at(1.0, start);
  const Vector3 expected = image_m(start, motion.point_m) + Vector3(0.08, 0.05, 0.0);
  EXPECT_LT((image_m(end, motion.point_m) - expected).norm(), rounding_m);
  EXPECT_LT(end.orientation.angularDistance(turn_by(Vector3::UnitZ(), 60.0) * start.orientation), 1e-7);
}

TEST(BodyMotion, IsMovedWithItsBody) {
  Body body = make_plate(lift_and_carry());
  const Vector3 point_m = body.surface.net.point(3, 3);
  const Pose before = MotionPath(*body.motion).at(0.7, {});
  const Pose moved{{0.1, 0.2, 0.3}, turn_by(Vector3(1.0, 2.0, 2.0) / 3.0, 45.0)};
  move_body(moved, body);
  const Pose after = MotionPath(*body.motion).at(0.7, {});
  EXPECT_LT((image_m(after, image_m(moved, point_m)) - image_m(moved, image_m(before, point_m))).norm(),
            rounding_m);
}

struct WrongMotion {
  const char* name;
  std::vector<Waypoint> waypoints;
  ErrorCode code;
  const char* field;
};

TEST(BodyMotion, NamesWhatIsWrong) {
  const Waypoint first{0.5, {0.1, 0.0, 0.0}};
  const WrongMotion wrong[] = {
      {"no waypoint", {}, ErrorCode::out_of_range, "waypoints"},
      {"time not after the one before", {first, first}, ErrorCode::inconsistent, "at_s"},
      {"time zero", {{0.0, Vector3::Zero()}}, ErrorCode::out_of_range, "at_s"},
      {"too far", {{5.0, {1.1, 0.0, 0.0}}}, ErrorCode::out_of_range, "moved_mm"},
      {"too fast", {first, {0.51, {0.15, 0.0, 0.0}}}, ErrorCode::inconsistent, "at_s"},
      {"turns too fast", {{0.1, Vector3::Zero(), Vector3::UnitX(), 90.0}}, ErrorCode::inconsistent, "at_s"},
      {"turns too far",
       {{5.0, Vector3::Zero(), Vector3::UnitX(), 150.0}},
       ErrorCode::inconsistent,
       "angle_deg"},
      {"not a unit vector", {{5.0, Vector3::Zero(), {1.0, 1.0, 0.0}, 50.0}}, ErrorCode::out_of_range, "axis"},
      {"not a number", {{std::nan(""), Vector3::Zero()}}, ErrorCode::out_of_range, "at_s"},
  };
  for (const WrongMotion& each : wrong) {
    const Status status = check_motion({Vector3::Zero(), each.waypoints});
    ASSERT_FALSE(status.ok()) << each.name;
    EXPECT_EQ(status.error().code, each.code) << each.name;
    EXPECT_EQ(status.error().field, each.field) << each.name;
  }
  EXPECT_EQ(check_motion({{std::nan(""), 0.0, 0.0}, {first}}).error().code, ErrorCode::out_of_range);
  EXPECT_TRUE(check_motion(lift_and_carry()).ok());
  const Vector3 here = Vector3::Zero();  // from 30 to 150 degrees is 120.00000000000001 degrees
  EXPECT_TRUE(
      check_motion({here, {{1.0, here, Vector3::UnitX(), 30.0}, {2.0, here, Vector3::UnitX(), 150.0}}}).ok());
}

// A soft block lies on a plate, which moves. Friction carries it along.
Scene block_on_moving_plate(const BodyMotion& motion) {
  Material gelatin = made_elastic(bundled_material("gelatin-10-1"));
  gelatin.friction = 0.5;
  Body block = stock_body("block", BoxSize{{0.03, 0.008, 0.02}, 0.001}, {0.0, 0.00401, 0.0}, gelatin, 300);
  Scene scene;
  scene.bodies = {block, make_plate(motion)};
  return make_trial_scene(scene, {}).value();
}

TEST(BodyMotion, MovesABodyInATrialAndCarriesWhatLiesOnIt) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const BodyMotion there{Vector3::Zero(), {{0.6, {0.06, 0.03, 0.0}, Vector3::UnitY(), 20.0}}};
  Simulation simulation = make_simulation(block_on_moving_plate(there));
  Trial trial(simulation.scene(), {0.2, 0.3});
  std::vector<TrialPhase> phases;
  while (trial.phase() != TrialPhase::done) {
    if (phases.empty() || phases.back() != trial.phase()) phases.push_back(trial.phase());
    while (const auto command = trial.next_command()) ASSERT_TRUE(simulation.apply(*command).ok());
    const std::size_t allocated = allocation_count();
    const Reaction reaction = simulation.advance(trial_input());
    if (!assertions_allocate) {
      EXPECT_EQ(allocation_count(), allocated);
    }
    ASSERT_TRUE(trial.follow(simulation, reaction.flags).ok());
  }
  EXPECT_EQ(phases, (std::vector{TrialPhase::settling, TrialPhase::moving, TrialPhase::watching}));
  const Pose pose = *simulation.rigid_pose(1);
  EXPECT_LT((pose.position_m - Vector3(0.06, 0.03, 0.0)).norm(), rounding_m);
  EXPECT_LT(pose.orientation.angularDistance(turn_by(Vector3::UnitY(), 20.0)), 1e-7);
  const Vector3 carried_m = find_mass_centre(simulation.lattice(0)).position_m;
  EXPECT_LT((carried_m - Vector3(0.06, 0.03 + 0.004, 0.0)).norm(), 1e-3);
}

// From 0.08 m aside and 0.05 m up to the start.
TEST(BodyMotion, IsInThePictureOfATrial) {
  Scene scene;
  scene.bodies = {make_plate({Vector3::Zero(), {{1.0, {0.08, 0.05, 0.0}}}})};
  Box box;
  box.include({-0.04, -0.004, -0.03});
  box.include({0.04, 0.0, 0.03});
  const Box all = find_box_of_motions(scene, box);
  EXPECT_LT((all.low - box.low).norm(), rounding_m);
  EXPECT_LT((all.high - Vector3(0.12, 0.05, 0.03)).norm(), rounding_m);
  // A turn before the motion: about z by 90 degrees, so that the plate stands upright.
  scene.trial = TrialPlan{"", 0.01, "plate", Vector3::Zero(), Vector3::UnitZ(), 90.0};
  EXPECT_NEAR(find_box_of_motions(scene, box).high.y(), 0.05 + 0.04, rounding_m);
}

TEST(BodyMotion, IsRefusedForABodyThatMovesByItself) {
  Simulation simulation = make_simulation(block_on_moving_plate(lift_and_carry()));
  EXPECT_EQ(simulation.apply(MoveBody{0, lift_and_carry()}).error().code, ErrorCode::inconsistent);
  EXPECT_EQ(simulation.apply(MoveBody{1, {}}).error().code, ErrorCode::out_of_range);
  EXPECT_EQ(simulation.apply(MoveBody{2, lift_and_carry()}).error().code, ErrorCode::out_of_range);
  EXPECT_FALSE(simulation.is_moving_bodies());
}

}  // namespace
}  // namespace spoonbill
