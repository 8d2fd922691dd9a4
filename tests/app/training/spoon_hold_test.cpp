// Tests that a spoon turns in a hand when its torque exceeds what the grip holds, in closed form.
#include "app/training/spoon_hold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/files/documents.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/trial.h"

namespace spoonbill {
namespace {

// A rigid bar in a hand, under gravity.
struct HeldBar {
  Simulation simulation;
  HeldSpoon held;
  double weight_n = 0.0;
  Vector3 centre_m = Vector3::Zero();  // of mass
};

HeldBar make_bar(double density_kg_per_m3) {
  Scene scene = read_document(std::string(SPOONBILL_ASSETS) + "/models/spoon-handle.json")->scene;
  scene.planes.clear();
  Body& body = scene.bodies.front();
  body.kind = BodyKind::rigid;
  body.hand = HandSpring{700.0, 3.0};
  body.material.density_kg_per_m3 = density_kg_per_m3;
  HeldSpoon held;
  held.spring = *body.hand;
  HeldBar bar{Simulation::make(make_trial_scene(scene, {}).value(), best_instruction_set()).value(), held,
              0.0, Vector3::Zero()};
  const RigidDynamics& dynamics = *bar.simulation.rigid_dynamics(0);
  bar.weight_n = standard_gravity_m_per_s2 * dynamics.mass().mass_kg;
  bar.centre_m = dynamics.centre_m();
  return bar;
}

// Holds the bar still for some ticks. Returns the angle by which it has turned in the hand.
double hold_still(HeldBar& bar, const std::optional<GripModel>& grip, int ticks) {
  SpoonHold hold(bar.held, grip);
  for (int k = 0; k < ticks; ++k) {
    ToolInput input = trial_input();
    input.carried = hold.carry({bar.held.grip_m, bar.held.handle});
    bar.simulation.advance(input);
    hold.follow(bar.simulation);
  }
  return hold.turned_rad();
}

// Returns whether the bar turns in a hand that holds it at rest and then takes this grip.
bool turns(HeldBar& bar, const GripModel& grip) {
  EXPECT_EQ(hold_still(bar, std::nullopt, 500), 0.0);
  return hold_still(bar, grip, 500) > 0.0;
}

constexpr double densities_kg_per_m3[] = {900.0, 2700.0, 8000.0};
constexpr double widths_m[] = {0.01, 0.02, 0.038};
constexpr double allowed = 0.02;  // part of the force of balance

// The grip force at which the torque of the grip equals that of the weight is known: the bar turns at 2 %
// less and not at 2 % more.
void expect_balance(const HeldSpoon& held, double density_kg_per_m3, GripModel grip, double balance_n) {
  for (const double factor : {1.0 - allowed, 1.0 + allowed}) {
    HeldBar bar = make_bar(density_kg_per_m3);
    bar.held = held;
    grip.force_n = factor * balance_n;
    EXPECT_EQ(turns(bar, grip), factor < 1.0)
        << density_kg_per_m3 << " kg/m3, handle of " << held.handle_width_m << " m, " << factor;
  }
}

TEST(SpoonHold, BarTurnsAboutTheHandleAtTheForceOfBalance) {
  constexpr double aside_m = 0.005;  // of the centre of mass from the axis of the handle
  for (const double density : densities_kg_per_m3) {
    for (const double width_m : widths_m) {
      const HeldBar bar = make_bar(density);
      HeldSpoon held = bar.held;
      held.grip_m = bar.centre_m + Vector3(0.0, 0.0, aside_m);
      held.handle_width_m = width_m;
      GripModel grip;
      expect_balance(held, density, grip, bar.weight_n * aside_m / (grip.friction * width_m));
    }
  }
}

TEST(SpoonHold, BarTurnsAcrossAFistAtTheForceOfBalance) {
  constexpr double behind_m = 0.04;
  for (const double density : densities_kg_per_m3) {
    const HeldBar bar = make_bar(density);
    HeldSpoon held = bar.held;
    held.grip_m = bar.centre_m - Vector3(behind_m, 0.0, 0.0);
    held.handle_width_m = 0.038;
    GripModel grip;
    expect_balance(held, density, grip, 3.0 * bar.weight_n * behind_m / (grip.friction * grip.breadth_m));
  }
}

TEST(SpoonHold, BarTurnsAcrossAPinchAtTheForceOfBalance) {
  constexpr double behind_m = 0.04;
  const HeldBar bar = make_bar(2700.0);
  HeldSpoon held = bar.held;
  held.grip_m = bar.centre_m - Vector3(behind_m, 0.0, 0.0);
  GripModel grip;
  grip.kind = GripKind::pinch;
  expect_balance(held, 2700.0, grip,
                 3.0 * bar.weight_n * behind_m / (4.0 * grip.friction * grip.pad_radius_m));
}

TEST(SpoonHold, WeakHandLetsTheFrontSink) {
  HeldBar bar = make_bar(8000.0);
  bar.held.grip_m = bar.centre_m - Vector3(0.04, 0.0, 0.0);
  GripModel grip;
  grip.force_n = 0.5 * 3.0 * bar.weight_n * 0.04 / (grip.friction * grip.breadth_m);
  EXPECT_TRUE(turns(bar, grip));
  const Pose pose = *bar.simulation.rigid_pose(0);
  EXPECT_LT((pose.orientation * Vector3::UnitX()).y(), -0.1);
  EXPECT_TRUE(pose.position_m.allFinite());
}

// A weak hand that moves five metres in a tick leaves a spoon behind that turns in it, and no value is lost.
TEST(SpoonHold, StaysFiniteWhereTheHandIsFarAway) {
  HeldBar bar = make_bar(900.0);
  bar.held.grip_m = bar.centre_m - Vector3(0.04, 0.0, 0.0);
  GripModel grip;
  grip.force_n = 0.1;
  SpoonHold hold(bar.held, grip);
  for (int k = 0; k < 200; ++k) {
    ToolInput input = trial_input();
    input.carried =
        hold.carry({bar.held.grip_m + Vector3(0.0, k % 100 < 50 ? 5.0 : 0.0, 0.0), bar.held.handle});
    bar.simulation.advance(input);
    hold.follow(bar.simulation);
    ASSERT_TRUE(std::isfinite(hold.torque().across_nm));
    ASSERT_TRUE(bar.simulation.rigid_pose(0)->position_m.allFinite());
  }
}

TEST(SpoonHold, HandWithoutAModelDoesNotGiveWay) {
  HeldBar bar = make_bar(8000.0);
  bar.held.grip_m = bar.centre_m - Vector3(0.04, 0.0, 0.0);
  SpoonHold hold(bar.held, std::nullopt);
  ToolInput input = trial_input();
  for (int k = 0; k < 500; ++k) {
    input.carried = hold.carry({bar.held.grip_m, bar.held.handle});
    bar.simulation.advance(input);
    hold.follow(bar.simulation);
  }
  EXPECT_EQ(hold.turned_rad(), 0.0);
  EXPECT_EQ(hold.torque().used(), 0.0);
  EXPECT_NEAR(hold.torque().across_nm, bar.weight_n * 0.04, 0.01 * bar.weight_n * 0.04);
}

}  // namespace
}  // namespace spoonbill
