// Tests trials: bodies in real time under gravity, their course and their report.
#include "engine/trial/trial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/base/processor.h"
#include "engine/scene/place_body.h"
#include "engine/simulation/body_contact.h"
#include "engine/simulation/body_hold.h"
#include "engine/trial/trial_report.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

Body soft_block(double friction, int node_budget = 300) {
  Material gelatin = made_elastic(bundled_material("gelatin-10-1"));
  gelatin.friction = friction;
  return stock_body("block", BoxSize{{0.03, 0.008, 0.02}, 0.001}, {0.0, 0.0042, 0.0}, gelatin, node_budget);
}

// A soft block 0.2 mm above a fixed plate, which turns about the z axis.
Scene block_over_plate(double friction, double angle_deg) {
  Body block = soft_block(friction);
  Material hard = bundled_material("abs");
  hard.friction = friction;
  Body plate = stock_body("plate", PlateSize{0.16, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0}, hard, 300);
  plate.kind = BodyKind::fixed;
  Scene scene;
  scene.bodies = {block, plate};
  scene.trial = TrialPlan{"block", 0.005, "plate", Vector3::Zero(), Vector3::UnitZ(), angle_deg, 60.0};
  return make_trial_scene(scene, {}).value();
}

struct RunTrial {
  std::vector<TrialPhase> phases;
  Status held;
  TrialReport report;
  bool settled = false;
  double largest_speed_m_per_s = 0.0, largest_penetration_m = 0.0;
};

RunTrial run_trial(Simulation& simulation, const TrialSettings& settings) {
  Trial trial(simulation.scene(), settings);
  RunTrial result;
  while (trial.phase() != TrialPhase::done && result.held.ok()) {
    if (result.phases.empty() || result.phases.back() != trial.phase())
      result.phases.push_back(trial.phase());
    while (const auto command = trial.next_command()) {
      EXPECT_TRUE(simulation.apply(*command).ok());
    }
    const Reaction reaction = simulation.advance(trial_input());
    result.held = trial.follow(simulation, reaction.flags);
  }
  result.report = report_on(trial, simulation);
  result.settled = trial.is_settled();
  result.largest_speed_m_per_s = trial.largest_speed_m_per_s();
  result.largest_penetration_m = trial.largest_penetration_m();
  return result;
}

TEST(Trial, LaysABlockOnAPlateAndTiltsIt) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Simulation simulation = make_simulation(block_over_plate(0.5, 10.0));
  const RunTrial result = run_trial(simulation, {0.5, 2.0});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  EXPECT_EQ(result.phases, (std::vector{TrialPhase::lowering, TrialPhase::settling, TrialPhase::turning,
                                        TrialPhase::watching}));
  const TrialBodyReport& block = result.report.bodies[0];
  const TrialBodyReport& plate = result.report.bodies[1];
  EXPECT_EQ(result.report.inertia_scale, 1.0);
  EXPECT_EQ(result.report.inverted_cells, 0);
  EXPECT_GT(block.smallest_jacobian, 0.5);
  EXPECT_NEAR(block.volume_ratio, 1.0, 0.01);
  EXPECT_LT(block.centre_of_mass_m.norm(), 0.01);  // it has not slid off
  const Vector3 weight_n(0.0, -standard_gravity_m_per_s2 * simulation.lattice(0).mass_kg(), 0.0);
  EXPECT_LT((plate.contact_force_n - weight_n).norm(), 0.01 * weight_n.norm());
  EXPECT_LT((block.contact_force_n + weight_n).norm(), 0.01 * weight_n.norm());
  EXPECT_EQ(block.support_force_n, Vector3::Zero());
  // The flat underside, from which the edges curve away.
  const double underside_m2 = 0.028 * 0.018, outline_m2 = 0.03 * 0.02;
  EXPECT_GT(simulation.contact_area_m2(0), 0.9 * underside_m2);
  EXPECT_LT(simulation.contact_area_m2(0), outline_m2);
  // The plate's own weight: 1.02 g/cm^3 times its volume, which its rounded corners make a little smaller.
  EXPECT_GT(plate.support_force_n.y(), -weight_n.y());
}

// A rigid body is let go at its first contact, and then rests and tilts with the plate.
TEST(Trial, LaysARigidBlockOnAPlate) {
  Scene scene = block_over_plate(0.5, 10.0);
  scene.bodies[0].kind = BodyKind::rigid;
  Simulation simulation = make_simulation(scene);
  const RunTrial result = run_trial(simulation, {0.5, 2.0});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  EXPECT_EQ(result.phases, (std::vector{TrialPhase::lowering, TrialPhase::settling, TrialPhase::turning,
                                        TrialPhase::watching}));
  EXPECT_TRUE(result.settled);
  EXPECT_LT(result.largest_penetration_m, 2e-5);  // two ticks of lowering
  const TrialBodyReport& block = result.report.bodies[0];
  const double weight_n = standard_gravity_m_per_s2 * simulation.rigid_dynamics(0)->mass().mass_kg;
  EXPECT_NEAR(block.contact_force_n.y(), weight_n, 0.01 * weight_n);
  EXPECT_LT(block.centre_of_mass_m.norm(), 0.01);  // it has not slid off
}

// Too little friction to hold the block at the angle.
TEST(Trial, ABlockSlidesOffASlipperyPlate) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Simulation simulation = make_simulation(block_over_plate(0.05, 20.0));
  const RunTrial result = run_trial(simulation, {0.3, 0.1});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  EXPECT_FALSE(result.settled);
  const double angle = 20.0 * std::numbers::pi / 180.0;
  // From the end of the turn it slides for 0.3 s at least, with g (sin t - mu cos t).
  const double slid_m =
      0.5 * standard_gravity_m_per_s2 * (std::sin(angle) - 0.05 * std::cos(angle)) * 0.3 * 0.3;
  EXPECT_GT(result.report.bodies[0].centre_of_mass_m.norm(), slid_m);
}

// Blocks of cells bent into a soft solid have flat corners, so a trial uses equal cells. Nodes that are
// counted are kept, and so is a stiff body's lattice, which the implicit solver steps.
TEST(Trial, GivesSoftSolidsEqualCells) {
  Scene scene;
  scene.bodies = {soft_block(0.3), soft_block(0.3), soft_block(0.3)};
  scene.bodies[1].lattice.counts = {6, 4, 5};
  scene.bodies[2].material = bundled_material("abs");
  const Scene trial = make_trial_scene(scene, {}).value();
  EXPECT_EQ(trial.bodies[0].lattice.cells, LatticeCells::box);
  EXPECT_EQ(trial.bodies[1].lattice.cells, LatticeCells::bent);
  EXPECT_EQ(trial.bodies[2].lattice.cells, LatticeCells::bent);
}

// A soft block falls by 50 mm and hits a plate at 1 m/s. Its nodes then move relative to each other by more
// than a tenth of a cell in the damping time.
TEST(Trial, ABlockFallsOntoAPlate) {
  Body block = soft_block(0.3);
  move_body({Vector3(0.0, 0.05, 0.0), Quaternion::Identity()}, block);
  Scene scene = block_over_plate(0.3, 0.0);
  scene.bodies[0] = block;
  scene.trial.reset();
  Simulation simulation = make_simulation(scene);
  const RunTrial result = run_trial(simulation, {0.05, 0.4});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  EXPECT_EQ(result.report.inverted_cells, 0);
  EXPECT_LT(result.report.bodies[0].centre_of_mass_m.y(), 0.02);
  EXPECT_GT(result.report.bodies[0].centre_of_mass_m.y(), 0.003);
}

// Two blocks that have fallen for 1.2 s move by 12 mm in a tick, but not towards each other or themselves.
TEST(Trial, BlocksThatFallSideBySideHaveFewContacts) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  Scene scene;
  scene.bodies = {soft_block(0.3), soft_block(0.3)};
  move_body({Vector3(0.0, 0.0081, 0.0), Quaternion::Identity()}, scene.bodies[1]);
  scene = make_trial_scene(scene, {}).value();
  Simulation simulation = make_simulation(scene);
  const RunTrial result = run_trial(simulation, {0.0, 1.2});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  EXPECT_EQ(result.report.inverted_cells, 0);
  EXPECT_LT(result.largest_penetration_m, 0.1 * static_cast<double>(simulation.lattice(0).cell_size_m()));
}

// The bundled jelly slides over the front rim of its spoon and falls. It never enters the spoon.
TEST(Trial, JellySlidesOffATiltedSpoon) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Scene scene = bundled_scene("jelly-on-spoon");
  Simulation simulation = make_simulation(make_trial_scene(scene, -30.0).value());
  const RunTrial result = run_trial(simulation, {0.3, 0.5});
  ASSERT_TRUE(result.held.ok()) << result.held.error().message;
  const double cell_m = static_cast<double>(simulation.lattice(0).cell_size_m());
  EXPECT_LT(result.largest_penetration_m, body_depth_limit_cells * cell_m);
  EXPECT_EQ(result.report.inverted_cells, 0);
  const TrialBodyReport &jelly = result.report.bodies[0], &spoon = result.report.bodies[1];
  EXPECT_LT(jelly.centre_of_mass_m.y(), spoon.centre_of_mass_m.y() - 0.02);
  ASSERT_TRUE(jelly.spill.has_value());
  EXPECT_FALSE(spoon.spill.has_value());
  EXPECT_DOUBLE_EQ(jelly.spill->outside_fraction, 1.0);
  EXPECT_TRUE(jelly.spill->first_spill_s && jelly.spill->left_s);
}

// The height of the centre of mass changes by what a falling body without contact loses.
TEST(Trial, KeepsTheEnergyOfAFallingBody) {
  Scene scene;
  scene.bodies = {soft_block(0.0)};
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  const Trial before(simulation.scene(), {});
  const double start_j = report_on(before, simulation).energy_j.value();
  const RunTrial result = run_trial(simulation, {0.1, 0.05});
  const double fallen_m =
      result.largest_speed_m_per_s * result.largest_speed_m_per_s / (2.0 * standard_gravity_m_per_s2);
  const double lost_j = simulation.lattice(0).mass_kg() * standard_gravity_m_per_s2 * fallen_m;
  // The symplectic Euler method is half a tick ahead.
  EXPECT_NEAR(result.report.energy_j.value(), start_j, 0.02 * lost_j);
  EXPECT_NEAR(result.report.bodies[0].centre_of_mass_m.y(), 0.0042 - fallen_m, 0.01 * fallen_m);
}

// A ball of almost undamped silicone in equal cells, whose nodes are not on its surface, falls by 2.8 mm.
TEST(Trial, ABallBouncesNoHigherThanItFell) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  constexpr double radius_m = 8e-3, fall_m = 2.8e-3;
  Material silicone = bundled_material("silicone-00-30");
  silicone.friction = 0.3;
  Scene scene;
  scene.bodies = {stock_body("ball", SphereSize{radius_m}, {0.0, radius_m + fall_m, 0.0}, silicone, 250)};
  scene.ground = Ground{};
  scene = make_trial_scene(scene, {}).value();
  ASSERT_EQ(scene.bodies[0].lattice.cells, LatticeCells::box);
  Simulation simulation = make_simulation(scene);
  const auto height_m = [&] { return find_mass_centre(simulation.lattice(0)).position_m.y(); };
  const double start_m = height_m();
  double lowest_m = start_m, highest_after_m = 0.0;
  for (int tick = 0; tick < 300; ++tick) {
    simulation.advance(trial_input());
    lowest_m = std::min(lowest_m, height_m());
    if (tick > 60) highest_after_m = std::max(highest_after_m, height_m());
  }
  EXPECT_LT(lowest_m, start_m - fall_m);
  EXPECT_LT(highest_after_m, start_m);
  EXPECT_GT(highest_after_m, start_m - fall_m);
}

TEST(Trial, MakesASceneTrue) {
  Scene scene;
  scene.bodies = {soft_block(0.0)};
  scene.sculpting.drag_per_s = 300.0;
  scene.sculpting.is_critically_damped = true;
  const Scene trial = make_trial_scene(scene, {}).value();
  EXPECT_EQ(trial.sculpting.drag_per_s, 0.0);
  EXPECT_FALSE(trial.sculpting.is_critically_damped);
  EXPECT_TRUE(trial.sculpting.real_time && trial.sculpting.free);
  EXPECT_EQ(trial.sculpting.gravity_m_per_s2, Vector3(0.0, -standard_gravity_m_per_s2, 0.0));
  scene.sculpting.gravity_m_per_s2 = {1.0, 0.0, 0.0};
  EXPECT_EQ(make_trial_scene(scene, {}).value().sculpting.gravity_m_per_s2, Vector3(1.0, 0.0, 0.0));
}

// A block at rest is found in the same place and bears the same force, whether its contacts are searched in
// each tick, as after a command, or only after it has moved.
TEST(Trial, ABlockRestsTheSameWithoutNewSearches) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  std::array<Vector3, 2> centre_m, force_n;
  for (const bool searches : {false, true}) {
    Simulation simulation = make_simulation(block_over_plate(0.5, 0.0));
    ASSERT_TRUE(simulation.apply(LowerBody{0, 0.02}).ok());
    force_n[searches].setZero();
    constexpr int ticks = 600, mean_ticks = 100;
    for (int t = 0; t < ticks; ++t) {
      if (searches) {
        ASSERT_TRUE(simulation.apply(ResetProxy{}).ok());
      }
      simulation.advance(trial_input());
      if (t >= ticks - mean_ticks) force_n[searches] += simulation.contact_force_n(0) / mean_ticks;
    }
    centre_m[searches] = find_mass_centre(simulation.lattice(0)).position_m;
  }
  EXPECT_LT((centre_m[0] - centre_m[1]).norm(), 1e-5);  // a two-hundredth of a cell
  EXPECT_LT((force_n[0] - force_n[1]).norm(), 0.005 * force_n[1].norm());
}

// A rigid body that is lowered fast is borne by a thin plate too, and is let go when gravity ends.
TEST(Trial, LowersARigidBlockFast) {
  Scene scene = block_over_plate(0.5, 0.0);
  scene.bodies[0].kind = BodyKind::rigid;
  move_body({{0.0, 0.0203, 0.0}, Quaternion::Identity()}, scene.bodies[0]);
  // The reach of contacts follows the size of the bodies, so a small plate is missed first.
  scene.bodies[1].surface = stock_surface(PlateSize{0.03, 0.02, 0.002, 0.003}, {0.0, -0.001, 0.0});
  const auto lower = [&](Simulation& simulation) {
    EXPECT_TRUE(simulation.apply(LowerBody{0, 1.0}).ok());
    for (int tick = 0; tick < 200 && simulation.is_moving_bodies(); ++tick) simulation.advance(trial_input());
    EXPECT_FALSE(simulation.is_moving_bodies());
    return simulation.rigid_dynamics(0)->centre_m().y();
  };
  Simulation falling = make_simulation(scene);
  EXPECT_NEAR(lower(falling), 0.004, 1.1e-3);  // half its height, within the motion of a tick
  scene.sculpting.gravity_m_per_s2.setZero();
  Simulation weightless = make_simulation(scene);
  Sculpting none = scene.sculpting;
  none.gravity_m_per_s2 = {0.0, -standard_gravity_m_per_s2, 0.0};
  ASSERT_TRUE(weightless.apply(SetSculpting{none}).ok());
  ASSERT_TRUE(weightless.apply(LowerBody{0, 0.001}).ok());
  ASSERT_TRUE(weightless.apply(SetSculpting{scene.sculpting}).ok());
  weightless.advance(trial_input());
  EXPECT_FALSE(weightless.is_moving_bodies());
}

// A divided step takes more substeps, and the block comes to rest at the same place.
TEST(Trial, RestsTheSameWithADividedStep) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const auto rest = [](int step_division, int& substeps) {
    Scene scene = block_over_plate(0.5, 0.0);
    scene.sculpting.step_division = step_division;
    Simulation simulation = make_simulation(scene);
    substeps = simulation.substeps();
    const RunTrial result = run_trial(simulation, {0.2, 2.0});
    EXPECT_TRUE(result.held.ok());
    return result.report.bodies[0].centre_of_mass_m;
  };
  int whole = 0, divided = 0;
  const Vector3 once = rest(1, whole), twice = rest(2, divided);
  EXPECT_EQ(divided, 2 * whole);
  const double moved_m = (once - Vector3(0.0, 0.0042, 0.0)).norm();
  EXPECT_LT((twice - once).norm(), 0.02 * moved_m);
}

TEST(Trial, ARefusedCommandChangesNothing) {
  Simulation simulation = make_simulation(block_over_plate(0.5, 0.0));
  ASSERT_TRUE(simulation.apply(LowerBody{0, 0.02}).ok());
  for (int t = 0; t < 50; ++t) simulation.advance(trial_input());
  ASSERT_GT(simulation.contact_force_n(0).norm(), 0.0);
  const std::uint64_t before = simulation.state_hash();
  EXPECT_FALSE(simulation.apply(TurnBody{}).ok());  // the first body deforms
  EXPECT_EQ(simulation.state_hash(), before);
}

// The block is 8 mm high and has a density of 1,000 kg/m^3: 0.3 of the pressure at its foot is 23.5 Pa.
TEST(Trial, RefusesALiquid) {
  Scene scene;
  scene.bodies = {soft_block(0.0)};
  Material& material = scene.bodies[0].material;
  material.plastic = true;
  material.youngs_modulus_pa = 1000.0;
  material.density_kg_per_m3 = 1000.0;
  material.flow_rate_per_s = 20.0;
  material.yield_strain = 0.023;
  EXPECT_EQ(make_trial_scene(scene, {}).error().field, "yield_strain");
  material.yield_strain = 0.024;
  EXPECT_TRUE(make_trial_scene(scene, {}).ok());
  scene.sculpting.gravity_m_per_s2 = {2.0 * standard_gravity_m_per_s2, 0.0, 0.0};  // along the 30 mm
  EXPECT_EQ(make_trial_scene(scene, {}).error().field, "yield_strain");
  scene.sculpting.gravity_m_per_s2.setZero();
  MaterialRegion region;
  region.material = material;
  region.material->yield_strain = 0.001;
  scene.bodies[0].regions = {region};
  EXPECT_EQ(make_trial_scene(scene, {}).error().field, "yield_strain");
}

TEST(Trial, RefusesAPlanThatDoesNotFitTheScene) {
  Scene scene;
  scene.bodies = {soft_block(0.0)};
  EXPECT_EQ(make_trial_scene(scene, 10.0).error().field, "turned_body");
  scene.trial.emplace().turned_body = "block";
  EXPECT_EQ(make_trial_scene(scene, {}).error().code, ErrorCode::inconsistent);
  scene.trial->turned_body = "spoon";
  EXPECT_EQ(make_trial_scene(scene, {}).error().code, ErrorCode::unknown);
  scene.trial.reset();
  scene.bodies[0].kind = BodyKind::fixed;
  EXPECT_EQ(make_trial_scene(scene, {}).error().code, ErrorCode::missing);
}

}  // namespace
}  // namespace spoonbill
