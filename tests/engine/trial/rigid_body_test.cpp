// Tests rigid bodies that move: they fall, slide, roll, spin, rest on each other, and are held by a hand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/base/processor.h"
#include "engine/material/rigid/rigid_mass.h"
#include "engine/scene/place_body.h"
#include "engine/simulation/body_hold.h"
#include "engine/trial/trial.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/rigid_samples.h"

namespace spoonbill {
namespace {

Material hard_material(double friction) {
  Material material = bundled_material("abs");
  material.friction = friction;
  return material;
}

Body rigid_body(const char* name, const StockShapeSize& size, const Vector3& centre_m, double friction) {
  Body body = stock_body(name, size, centre_m, hard_material(friction), 300);
  body.kind = BodyKind::rigid;
  return body;
}

Body rigid_block(const Vector3& centre_m, double friction) {
  return rigid_body("block", BoxSize{{0.03, 0.008, 0.02}, 0.0005}, centre_m, friction);
}

Body fixed_plate(double friction) {
  Body plate = rigid_body("plate", PlateSize{0.16, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0}, friction);
  plate.kind = BodyKind::fixed;
  return plate;
}

Ground ground_with(double friction) {
  return {Vector3::Zero(), Vector3::UnitY(), friction};
}

Simulation make_weightless(const Scene& scene) {
  Scene free = scene;
  free.sculpting.free = true;
  free.sculpting.real_time = true;
  free.sculpting.drag_per_s = 0.0;
  return make_simulation(free);
}

double kinetic_energy_j(const RigidDynamics& rigid) {
  return rigid.energy_j(Vector3::Zero());
}

Vector3 angular_momentum(const RigidDynamics& rigid) {
  const Eigen::Matrix3d turn = rigid.pose().orientation.toRotationMatrix();
  return turn * rigid.mass().inertia_kg_m2 * turn.transpose() * rigid.spin_rad_per_s();
}

// A ball of radius R has the inertia 2/5 m R^2. The stock shape is fitted to the ball to within a thousandth
// of its radius.
TEST(RigidMass, IsThatOfABall) {
  const Body ball = rigid_body("ball", SphereSize{0.02}, {0.5, -0.3, 0.1}, 0.0);
  const RigidMass mass = compute_rigid_mass(ball).value();
  const double expected_kg =
      ball.material.density_kg_per_m3 * 4.0 / 3.0 * std::numbers::pi * std::pow(0.02, 3.0);
  EXPECT_NEAR(mass.mass_kg, expected_kg, 3e-3 * expected_kg);
  EXPECT_LT((mass.centre_m - Vector3(0.5, -0.3, 0.1)).norm(), 1e-6);
  const double inertia = 0.4 * mass.mass_kg * 0.02 * 0.02;
  EXPECT_LT((mass.inertia_kg_m2 - inertia * Eigen::Matrix3d::Identity()).norm(), 5e-3 * inertia);
}

// The tensor of a body that is turned is the turned tensor.
TEST(RigidMass, TurnsWithTheBody) {
  Body block = rigid_block(Vector3::Zero(), 0.0);
  const RigidMass before = compute_rigid_mass(block).value();
  const Pose pose{{0.1, 0.2, -0.3}, Quaternion(Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, -2.0) / 3.0))};
  move_body(pose, block);
  const RigidMass after = compute_rigid_mass(block).value();
  const Eigen::Matrix3d turn = pose.orientation.toRotationMatrix();
  const Eigen::Matrix3d expected = turn * before.inertia_kg_m2 * turn.transpose();
  EXPECT_LT((after.inertia_kg_m2 - expected).norm(), 1e-12 * expected.norm() + 1e-18);
  EXPECT_LT((after.centre_m - pose.position_m - pose.orientation * before.centre_m).norm(), 1e-12);
}

// A thin flat shell of the sides a and b has the inertia m (a^2 + b^2) / 12 about its normal. Its centre is
// half the thickness below its surface.
TEST(RigidMass, IsThatOfAThinPlateForAShell) {
  Body sheet;
  sheet.surface = stock_surface(SheetSize{0.06, 0.04});
  sheet.material = hard_material(0.0);
  sheet.shell_thickness_m = 0.001;
  const RigidMass mass = compute_rigid_mass(sheet).value();
  EXPECT_NEAR(mass.mass_kg, sheet.material.density_kg_per_m3 * 0.06 * 0.04 * 0.001, 1e-9);
  EXPECT_NEAR(mass.inertia_kg_m2(1, 1), mass.mass_kg * (0.06 * 0.06 + 0.04 * 0.04) / 12.0,
              1e-6 * mass.inertia_kg_m2(1, 1));
  EXPECT_NEAR(mass.centre_m.norm(), 0.0005, 1e-9);
  sheet.shell_thickness_m.reset();
  EXPECT_FALSE(compute_rigid_mass(sheet).has_value());
}

TEST(RigidBody, FallsFreely) {
  Scene scene;
  scene.bodies = {rigid_block({0.0, 0.5, 0.0}, 0.3)};
  Simulation simulation = make_trial_of(scene);
  run_trial_ticks(simulation, 200);
  const RigidDynamics& block = *simulation.rigid_dynamics(0);
  EXPECT_NEAR(-block.velocity_m_per_s().y(), 0.2 * standard_gravity_m_per_s2,
              1e-3 * 0.2 * standard_gravity_m_per_s2);
  // Symplectic Euler steps fall farther than g t^2 / 2 by half a substep's velocity.
  EXPECT_NEAR(0.5 - block.centre_m().y(), 0.5 * standard_gravity_m_per_s2 * 0.04,
              2e-3 * 0.5 * standard_gravity_m_per_s2 * 0.04);
  EXPECT_EQ(block.spin_rad_per_s(), Vector3::Zero());
}

// A block that spins about its middle axis tumbles (Euler 1765). Without forces, angular momentum is constant
// and so is the energy. An error of second order in the step shows in the energy alone.
TEST(RigidBody, KeepsItsMomentumAndEnergyWhileItTumbles) {
  Scene scene;
  scene.bodies = {rigid_block(Vector3::Zero(), 0.3)};
  Simulation simulation = make_weightless(scene);
  RigidDynamics block(simulation.rigid_dynamics(0)->mass(), simulation.lattice(0).mesh());
  SpringLattice frame = simulation.lattice(0);
  const LatticeView view = frame.view();
  block.set_velocity({0.1, 0.0, 0.0}, {0.2, 0.1, 20.0});
  block.place_nodes(view);
  const Vector3 momentum = angular_momentum(block);
  const double energy_j = kinetic_energy_j(block);
  double largest_tilt = 0.0;
  for (int t = 0; t < 8000; ++t) {
    block.kick(2.5e-4, Vector3::Zero(), 0.0, nullptr, {});
    block.drift(view, 2.5e-4);
    largest_tilt = std::max(largest_tilt, 1.0 - (block.pose().orientation * Vector3::UnitZ()).z());
  }
  EXPECT_LT((angular_momentum(block) - momentum).norm(), 1e-9 * momentum.norm());
  EXPECT_NEAR(kinetic_energy_j(block), energy_j, 1e-3 * energy_j);
  EXPECT_GT(largest_tilt, 0.0);
  EXPECT_NEAR(block.centre_m().x(), 0.1 * 8000 * 2.5e-4, 1e-9);
}

TEST(RigidBody, SlidesAndSticksOnTheGround) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double friction : is_full_run() ? std::vector{0.05, 0.1, 0.3, 0.6} : std::vector{0.3}) {
    Scene scene;
    scene.bodies = {rigid_block({0.0, 0.00401, 0.0}, friction)};
    scene.ground = ground_with(friction);
    check_friction(scene, friction);
  }
}

TEST(RigidBody, SlidesAndSticksOnAPlate) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double friction : is_full_run() ? std::vector{0.05, 0.1, 0.3, 0.6} : std::vector{0.3}) {
    Scene scene;
    scene.bodies = {rigid_block({-0.04, 0.00401, 0.0}, friction), fixed_plate(friction)};
    check_friction(scene, friction);
  }
}

// A ball that does not slip rolls down a slope with 5/7 g sin t. Contacts lag its motion by up to a tick.
TEST(RigidBody, RollsDownASlope) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const double slope = 5.0 * std::numbers::pi / 180.0;
  const double expected_m_per_s = 5.0 / 7.0 * standard_gravity_m_per_s2 * std::sin(slope) * 0.2;
  Scene scene;
  scene.bodies = {rigid_body("ball", SphereSize{0.015}, {-0.03, 0.015, 0.0}, 0.5)};
  Scene on_plate = scene;
  on_plate.bodies.push_back(fixed_plate(0.5));
  scene.ground = ground_with(0.5);
  for (const Scene& each : {scene, on_plate}) {
    Simulation simulation = make_trial_of(each, slope);
    run_trial_ticks(simulation, 200);
    const RigidDynamics& ball = *simulation.rigid_dynamics(0);
    EXPECT_NEAR(ball.velocity_m_per_s().x(), expected_m_per_s, 0.1 * expected_m_per_s);
    EXPECT_NEAR(-ball.spin_rad_per_s().z(), ball.velocity_m_per_s().x() / 0.015,
                0.02 * ball.spin_rad_per_s().norm());
    EXPECT_NEAR(ball.centre_m().y(), 0.015, 5e-5);
  }
}

// A block that falls onto a corner comes to rest on a face, and loses its energy on the way.
TEST(RigidBody, FallsOntoACornerAndComesToRest) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Body block = rigid_body("block", BoxSize{{0.03, 0.03, 0.02}, 0.0005}, {0.0, 0.04, 0.0}, 0.3);
  move_body({Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5, Vector3(1.0, 0.3, 0.7).normalized()))},
            block);
  Scene scene;
  scene.bodies = {block};
  scene.ground = ground_with(0.3);
  Simulation simulation = make_trial_of(scene);
  const RigidDynamics& moved = *simulation.rigid_dynamics(0);
  const Vector3& gravity = simulation.scene().sculpting.gravity_m_per_s2;
  const double start_j = moved.energy_j(gravity), height_j = start_j;
  double highest_j = start_j;
  for (int t = 0; t < 600; ++t) {
    simulation.advance(trial_input());
    highest_j = std::max(highest_j, moved.energy_j(gravity));
  }
  EXPECT_LT(highest_j, start_j + 0.01 * height_j);
  EXPECT_LT(moved.velocity_m_per_s().norm() + 0.03 * moved.spin_rad_per_s().norm(), settled_speed_m_per_s);
  const double lowest_m = std::min(0.01, 0.015);
  EXPECT_GT(moved.centre_m().y(), lowest_m - 5e-5);
  EXPECT_LT(moved.centre_m().y(), 0.0151);
  const double weight_n = moved.mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.ground_force_n(0).y(), weight_n, 5e-3 * weight_n);
  EXPECT_GT(simulation.contact_area_m2(0), 0.0);
}

// A ball that arrives with 1 m/s does not pass through a wall of half a millimetre.
TEST(RigidBody, DoesNotPassThroughAThinWall) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Body wall = rigid_body("wall", PlateSize{0.06, 0.06, 0.0005, 0.006}, {0.0, -0.00025, 0.0}, 0.3);
  wall.kind = BodyKind::fixed;
  for (const double offset_m : {0.0, 0.0137}) {
    Scene scene;
    scene.bodies = {rigid_body("ball", SphereSize{0.004}, {offset_m, 0.055, 0.3 * offset_m}, 0.3), wall};
    Simulation simulation = make_trial_of(scene);
    const double overlap_m = run_trial_ticks(simulation, 150);
    const RigidDynamics& ball = *simulation.rigid_dynamics(0);
    EXPECT_NEAR(ball.centre_m().y(), 0.004, 2e-5);
    EXPECT_LT(ball.velocity_m_per_s().norm(), 1e-2);
    EXPECT_LT(overlap_m, 0.0005 / 3.0);
  }
}

// Three blocks, each beside the middle of the one below, stand still.
TEST(RigidBody, StandsInAStack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Scene scene;
  for (int level = 0; level < 3; ++level) {
    const Vector3 centre_m(0.002 * level, 0.005 + 0.01002 * level, 0.001 * level);
    scene.bodies.push_back(rigid_body("block", BoxSize{{0.03, 0.01, 0.02}, 0.0005}, centre_m, 0.5));
    scene.bodies.back().name += std::to_string(level);
  }
  scene.ground = ground_with(0.5);
  Simulation simulation = make_trial_of(scene);
  check_stands_still(simulation, 2);
  const double weight_n = simulation.rigid_dynamics(0)->mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.ground_force_n(0).y(), 3.0 * weight_n, 0.02 * weight_n);
  EXPECT_NEAR(simulation.contact_force_n(0).y(), -2.0 * weight_n, 0.02 * weight_n);
  EXPECT_NEAR(simulation.contact_force_n(2).y(), weight_n, 0.02 * weight_n);
}

// A soft body bears a rigid one, and each feels the other's weight.
TEST(RigidBody, RestsOnASoftBody) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Material soft = made_elastic(bundled_material("gelatin-10-1"));
  soft.friction = 0.3;
  Scene scene;
  scene.bodies = {stock_body("jelly", BoxSize{{0.03, 0.015, 0.03}, 0.001}, {0.0, 0.0075, 0.0}, soft, 300),
                  rigid_body("block", BoxSize{{0.015, 0.004, 0.015}, 0.0005}, {0.0, 0.01705, 0.0}, 0.3)};
  scene.ground = ground_with(0.5);
  Simulation simulation = make_trial_of(scene);
  run_trial_ticks(simulation, 500);
  const double overlap_m = run_trial_ticks(simulation, 100);
  const RigidDynamics& block = *simulation.rigid_dynamics(1);
  const double weight_n = block.mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.contact_force_n(1).y(), weight_n, 5e-3 * weight_n);
  EXPECT_NEAR(simulation.contact_force_n(0).y(), -weight_n, 5e-3 * weight_n);
  const double together_n = weight_n + simulation.lattice(0).mass_kg() * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.ground_force_n(0).y(), together_n, 5e-3 * together_n);
  EXPECT_LT(block.velocity_m_per_s().norm(), settled_speed_m_per_s);
  EXPECT_LT(overlap_m, 5e-5);
}

// A block that a weak hand holds.
Scene held_block(double height_m) {
  Scene scene;
  scene.bodies = {rigid_block({0.0, height_m, 0.0}, 0.3)};
  scene.bodies[0].hand = HandSpring{50.0, 0.02};
  return scene;
}

// A hand spring of the stiffness k yields to the weight by m g / k, and turns with the hand.
TEST(HeldBody, SagsByItsWeightAndFollowsTheHand) {
  Simulation simulation = make_trial_of(held_block(0.1));
  run_trial_ticks(simulation, 600);
  const RigidDynamics& block = *simulation.rigid_dynamics(0);
  const double weight_n = block.mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(0.1 - block.centre_m().y(), weight_n / 50.0, 1e-3 * weight_n / 50.0);
  EXPECT_NEAR(block.hand_impulse_ns().y() / tick_s, weight_n, 1e-3 * weight_n);
  const ShapeState kept = simulation.shape();
  TurnBody turn;
  turn.point_m = {0.0, 0.1, 0.0};
  turn.axis = Vector3::UnitX();
  turn.angle_deg = 30.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  run_trial_ticks(simulation, static_cast<int>(turn_duration_s(turn) / tick_s) + 400);
  const Eigen::AngleAxisd turned(block.pose().orientation);
  EXPECT_NEAR(turned.angle(), std::numbers::pi / 6.0, 1e-3);
  EXPECT_NEAR(turned.axis().x(), 1.0, 1e-6);
  // The hand is back where it was, so the body stays where it was put.
  ASSERT_TRUE(simulation.restore(kept).ok());
  EXPECT_TRUE(simulation.shape() == kept);
  const Vector3 before = block.centre_m();
  run_trial_ticks(simulation, 200);
  EXPECT_LT((block.centre_m() - before).norm(), 1e-6);
}

// Ground and hand share the weight, and the hand's force includes how its spring responds to the ground.
TEST(HeldBody, IsBorneByTheGroundAndTheHand) {
  Scene scene = held_block(0.004);
  scene.ground = ground_with(0.3);
  scene.ground->point_m.y() = 5e-4;  // the hand presses the block upon the ground
  Simulation simulation = make_trial_of(scene);
  run_trial_ticks(simulation, 600);
  const RigidDynamics& block = *simulation.rigid_dynamics(0);
  const double hand_n = block.hand_impulse_ns().y() / tick_s, ground_n = simulation.ground_force_n(0).y();
  const double weight_n = block.mass().mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(hand_n + ground_n, weight_n, 1e-3 * weight_n);
  EXPECT_NEAR(hand_n, -50.0 * (block.centre_m().y() - 0.004), 0.01 * std::abs(hand_n));
  EXPECT_LT(hand_n, 0.0);
}

// Keeping the shape changes neither pose nor hand nor mass.
TEST(HeldBody, KeepsItsPlaceWhenItsShapeIsKept) {
  Simulation simulation = make_trial_of(held_block(0.1));
  TurnBody turn;
  turn.point_m = {0.02, 0.1, 0.0};
  turn.axis = Vector3::UnitZ();
  turn.angle_deg = 40.0;
  ASSERT_TRUE(simulation.apply(turn).ok());
  run_trial_ticks(simulation, static_cast<int>(turn_duration_s(turn) / tick_s) + 600);
  const Vector3 before = simulation.rigid_dynamics(0)->centre_m();
  const Surface surface = simulation.surface(0);
  ASSERT_TRUE(simulation.apply(KeepShape{}).ok());
  run_trial_ticks(simulation, 300);
  EXPECT_LT((simulation.rigid_dynamics(0)->centre_m() - before).norm(), 1e-6);
  EXPECT_LT((simulation.surface(0).net.point(3, 3) - surface.net.point(3, 3)).norm(), 2e-6);
}

// The tool pushes a free block, which hits another one. Their momentum is the impulse that the hand feels.
TEST(RigidBody, IsPushedByTheToolAndHitsAnotherBody) {
  Scene scene;
  const BoxSize size{{0.02, 0.02, 0.02}, 0.002};
  scene.bodies = {rigid_body("near", size, Vector3::Zero(), 0.0),
                  rigid_body("far", size, {0.021, 0.003, 0.0}, 0.0)};
  scene.tool.kind = ToolKind::sphere;
  scene.tool.radius_m = 0.005;
  Simulation simulation = make_weightless(scene);
  ToolInput input;
  input.coupling_n_per_m = 300.0;
  Vector3 impulse_ns = Vector3::Zero();
  double overlap_m = 0.0;
  for (int t = 0; t < 400; ++t) {
    input.pose.position_m = {-0.016 + 2e-5 * t, 0.0, 0.0};
    impulse_ns -= tick_s * simulation.advance(input).force_n;
    overlap_m = std::max(overlap_m, simulation.largest_overlap_m());
  }
  Vector3 momentum = Vector3::Zero();
  for (int b = 0; b < 2; ++b) {
    const RigidDynamics& block = *simulation.rigid_dynamics(b);
    EXPECT_GT(block.velocity_m_per_s().x(), 0.01);
    momentum += block.mass().mass_kg * block.velocity_m_per_s();
  }
  EXPECT_LT((momentum - impulse_ns).norm(), 1e-6 * momentum.norm());
  EXPECT_LT(overlap_m, 5e-5);
}

// Without gravity and ground, a free body of a sculpting scene keeps its place, as deformable ones do.
TEST(RigidBody, KeepsItsPlaceWhileItIsSculpted) {
  Scene scene;
  scene.bodies = {rigid_body("block", BoxSize{{0.02, 0.02, 0.02}, 0.002}, Vector3::Zero(), 0.0)};
  scene.tool.kind = ToolKind::sphere;
  scene.tool.radius_m = 0.005;
  Simulation simulation = make_simulation(scene);
  ToolInput input;
  input.coupling_n_per_m = 300.0;
  input.pose.position_m = {-0.014, 0.0, 0.0};
  double force_n = 0.0;
  for (int t = 0; t < 100; ++t) force_n = simulation.advance(input).force_n.norm();
  EXPECT_GT(force_n, 0.01);
  EXPECT_EQ(simulation.rigid_dynamics(0)->pose(), Pose());
}

TEST(RigidBody, WeighsMoreWithADenserMaterial) {
  Scene scene;
  scene.bodies = {rigid_block({0.0, 0.0041, 0.0}, 0.3)};
  scene.ground = ground_with(0.3);
  Simulation simulation = make_trial_of(scene);
  Material denser = scene.bodies[0].material;
  denser.density_kg_per_m3 *= 3.0;
  const double mass_kg = simulation.rigid_dynamics(0)->mass().mass_kg;
  ASSERT_TRUE(simulation.apply(SetMaterial{denser, 0}).ok());
  run_trial_ticks(simulation, 200);
  const double weight_n = 3.0 * mass_kg * standard_gravity_m_per_s2;
  EXPECT_NEAR(simulation.ground_force_n(0).y(), weight_n, 5e-3 * weight_n);
}

// A shell touches the ground with its far face if that is below.
TEST(RigidBody, AShellLiesOnEitherFace) {
  for (const bool is_turned : {false, true}) {
    Body sheet;
    sheet.name = "sheet";
    sheet.surface = stock_surface(SheetSize{0.03, 0.02});
    sheet.material = hard_material(0.3);
    sheet.shell_thickness_m = 0.002;
    sheet.kind = BodyKind::rigid;
    const double angle = is_turned ? std::numbers::pi : 0.0;
    move_body({{0.0, 0.003, 0.0}, Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitX()))}, sheet);
    Scene scene;
    scene.bodies = {sheet};
    scene.ground = ground_with(0.3);
    Simulation simulation = make_trial_of(scene);
    run_trial_ticks(simulation, 150);
    EXPECT_NEAR(simulation.rigid_dynamics(0)->centre_m().y(), 0.001, 2e-5) << is_turned;
  }
}

TEST(RigidBody, AllocatesNothingInATick) {
  if (assertions_allocate) GTEST_SKIP() << "assertions allocate in this build";
  Scene scene;
  scene.bodies = {rigid_block({0.0, 0.0045, 0.0}, 0.3), rigid_block({0.001, 0.0130, 0.0}, 0.3),
                  fixed_plate(0.3)};
  scene.bodies[1].name = "upper";
  scene.ground = ground_with(0.3);
  Simulation simulation = make_trial_of(scene);
  run_trial_ticks(simulation, 5);
  for (int t = 0; t < 60; ++t) {
    const std::size_t allocated = allocation_count();
    simulation.advance(trial_input());
    EXPECT_EQ(allocation_count(), allocated);
  }
}

TEST(RigidBody, RefusesWhatItCannotDo) {
  Scene scene;
  scene.bodies = {rigid_block({0.0, 0.1, 0.0}, 0.3)};
  Simulation simulation = make_trial_of(scene);
  EXPECT_EQ(simulation.apply(TurnBody{}).error().code, ErrorCode::inconsistent);
  Scene gripped = scene;
  gripped.bodies[0].hand.emplace();
  EXPECT_EQ(make_trial_of(gripped).apply(LowerBody{0, 0.01}).error().code, ErrorCode::inconsistent);
  Scene open = scene;
  open.bodies[0].surface = stock_surface(SheetSize{0.06, 0.04});
  EXPECT_FALSE(Simulation::make(open, InstructionSet::baseline).ok());
  Scene held = scene;
  held.bodies[0].kind = BodyKind::fixed;
  held.bodies[0].hand.emplace();
  const auto refused = Simulation::make(held, InstructionSet::baseline);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().field, "hand");
}

}  // namespace
}  // namespace spoonbill
