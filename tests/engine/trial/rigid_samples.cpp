#include "tests/engine/trial/rigid_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/trial/trial.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {

Simulation make_trial_of(Scene scene, double slope_rad) {
  scene.sculpting.gravity_m_per_s2 =
      standard_gravity_m_per_s2 * Vector3(std::sin(slope_rad), -std::cos(slope_rad), 0.0);
  return make_simulation(make_trial_scene(scene, {}).value());
}

double run_trial_ticks(Simulation& simulation, int ticks) {
  double overlap_m = 0.0;
  for (int t = 0; t < ticks; ++t) {
    const Reaction reaction = simulation.advance(trial_input());
    EXPECT_EQ(reaction.flags, tick_flag_none);
    overlap_m = std::max(overlap_m, simulation.largest_overlap_m());
  }
  return overlap_m;
}

void check_friction(const Scene& scene, double friction) {
  const double angle = std::atan(friction);
  Simulation sticking = make_trial_of(scene, angle - 0.3 * std::numbers::pi / 180.0);
  run_trial_ticks(sticking, 1000);
  const Vector3 before = sticking.rigid_dynamics(0)->centre_m();
  run_trial_ticks(sticking, is_full_run() ? 10000 : 500);
  EXPECT_LT((sticking.rigid_dynamics(0)->centre_m() - before).norm(), 1e-4) << friction;

  for (const double beyond_deg : {0.3, 5.0}) {
    const double steep = angle + beyond_deg * std::numbers::pi / 180.0;
    const double expected = standard_gravity_m_per_s2 * (std::sin(steep) - friction * std::cos(steep));
    Simulation sliding = make_trial_of(scene, steep);
    run_trial_ticks(sliding, 50);
    const double start = sliding.rigid_dynamics(0)->velocity_m_per_s().x();
    run_trial_ticks(sliding, 200);
    const double acceleration = (sliding.rigid_dynamics(0)->velocity_m_per_s().x() - start) / 0.2;
    EXPECT_NEAR(acceleration, expected, 0.02 * expected) << friction << " " << beyond_deg;
  }
}

void check_stands_still(Simulation& simulation, int top) {
  run_trial_ticks(simulation, 300);
  const Vector3 before = simulation.rigid_dynamics(top)->centre_m();
  EXPECT_LT(run_trial_ticks(simulation, 300), 2e-5);
  EXPECT_LT((simulation.rigid_dynamics(top)->centre_m() - before).norm(), 1e-5);
}

}  // namespace spoonbill
