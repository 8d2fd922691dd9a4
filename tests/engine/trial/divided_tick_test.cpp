// Tests ticks that are divided because bodies near each other are fast. That such bodies do not overlap is
// tested by the random scenes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/rigid_samples.h"

namespace spoonbill {
namespace {

Body make_body(const char* name, const StockShapeSize& size, const Vector3& centre_m, const char* material,
               BodyKind kind) {
  Body body = stock_body(name, size, centre_m, bundled_material(material), 300);
  body.kind = kind;
  return body;
}

// A steel ball that falls from 60 mm onto a cushion, which it meets at 1 m/s.
Scene ball_over_cushion(const char* cushion) {
  Scene scene;
  scene.bodies = {make_body("ball", SphereSize{0.006}, {0.0, 0.072, 0.0}, "steel-304", BodyKind::rigid),
                  make_body("cushion", BoxSize{{0.03, 0.012, 0.03}, 0.002}, {0.0, 0.006, 0.0}, cushion,
                            BodyKind::deformable)};
  scene.ground = Ground{Vector3::Zero(), Vector3::UnitY(), 0.5};
  return scene;
}

class DividedTick : public testing::TestWithParam<const char*> {};

// The parts of a tick have impulses of their own. Their sum over the time of the tick is the force, by
// Newton's second law; the tolerance allows for the rounding of velocities to single precision.
TEST_P(DividedTick, ReportsTheForceThatChangesTheMomentum) {
  Simulation simulation = make_trial_of(ball_over_cushion(GetParam()));
  const RigidDynamics& ball = *simulation.rigid_dynamics(0);
  const double mass_kg = ball.mass().mass_kg;
  const Vector3 weight_n = mass_kg * simulation.scene().sculpting.gravity_m_per_s2;
  double largest_n = 0.0;
  Vector3 before = ball.velocity_m_per_s();
  for (int tick = 0; tick < 200; ++tick) {
    simulation.advance(trial_input());
    const Vector3 now = simulation.rigid_dynamics(0)->velocity_m_per_s();
    const Vector3 expected_n = mass_kg * (now - before) / tick_s - weight_n;
    const double size_n = expected_n.norm();
    EXPECT_LT((simulation.contact_force_n(0) - expected_n).norm(), 1e-4 * size_n + 1e-6) << tick;
    largest_n = std::max(largest_n, size_n);
    before = now;
  }
  EXPECT_GT(largest_n, 20.0 * weight_n.norm());
}

INSTANTIATE_TEST_SUITE_P(Cushions, DividedTick, testing::Values("silicone-00-30", "silicone-soft"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// A plate that swings at 2 m/s meets a ball, and still is where its motion says.
TEST(DividedTick, KeepsThePrescribedMotion) {
  Scene scene;
  scene.bodies = {
      make_body("plate", BoxSize{{0.04, 0.04, 0.004}, 0.001}, Vector3::Zero(), "abs", BodyKind::fixed),
      make_body("ball", SphereSize{0.006}, {0.01, 0.0, 0.03}, "silicone-00-30", BodyKind::deformable)};
  Simulation simulation = make_trial_of(scene);
  const TurnBody turn{0, {-0.3, 0.0, 0.0}, -Vector3::UnitY(), 10.0, 360.0};
  ASSERT_TRUE(simulation.apply(turn).ok());
  bool has_met = false;
  for (int tick = 1; simulation.is_moving_bodies(); ++tick) {
    simulation.advance(trial_input());
    const double angle = turned_angle_deg(turn, tick * tick_s) * std::numbers::pi / 180.0;
    const Quaternion expected(Eigen::AngleAxisd(angle, turn.axis));
    EXPECT_LT(simulation.rigid_pose(0)->orientation.angularDistance(expected), 1e-9) << tick;
    has_met |= !simulation.contact_force_n(1).isZero(0.0);
  }
  EXPECT_TRUE(has_met);
}

}  // namespace
}  // namespace spoonbill
