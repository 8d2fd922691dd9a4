// Tests that sculpted bodies come to rest without ringing.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/material/lattice_solver.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/block.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/loaded_block.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

// Returns a bar that is fixed at its lower end and pushed sideways at the other end.
LoadedBlock pushed_bar(Stepping stepping) {
  const bool springs = stepping == Stepping::springs;
  Material material = elastic_material(springs ? 2e4 : 2e6, 0.3, 1000.0);
  material.damping_time_s = 1.2e-5;
  LoadedBlock bar({0.012, 0.012, 0.06}, {4, 4, 16}, material, stepping);
  bar.support({{{{0.0, 0.0}}, {}}});
  bar.load({ForceLoad{{{1.0, 1.0}}, Vector3(5e-8 * material.youngs_modulus_pa, 0, 0)}});
  return bar;
}

double tip_m(const LoadedBlock& bar) {
  return bar.slice_m(15).x();
}

TEST(Settling, IsCriticalForTheMotionThatABodyIsIn) {
  LoadedBlock bar = pushed_bar(Stepping::springs);
  // The first mode remains after the fast modes have decayed. The Rayleigh quotient is then the square of the
  // mode's angular frequency.
  for (int tick = 0; tick < 400; ++tick) bar.tick(0.0);
  double longest = 0.0, last_turn = 0.0, before = tip_m(bar), way = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    bar.tick(0.0);
    const double next = tip_m(bar) - before;
    if (next * way < 0.0) {
      if (last_turn > 0.0) longest = bar.time_s - last_turn;
      last_turn = bar.time_s;
    }
    way = next;
    before = tip_m(bar);
  }
  double quotient = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    bar.tick(0.0);
    const LatticeView view = bar.lattice.view();
    take_forces(bar.lattice, 0.0f);
    const double energy = bar.kinetic_energy_j();
    quotient += energy > 0.0 ? rayleigh_quotient(bar.lattice, view) / 200.0 : 0.0;
  }
  ASSERT_GT(longest, 0.0);
  const double omega = std::acos(-1.0) / longest;
  // Other modes that still vibrate can only make the quotient larger.
  EXPECT_GT(std::sqrt(quotient), 0.9 * omega);
  EXPECT_LT(std::sqrt(quotient), 3.0 * omega);
}

// An oscillator at 1.1 times critical damping has at most 0.12 of its energy in motion. The limit of 0.15
// allows for the higher modes.
TEST(Settling, AReleasedBodyComesBackWithoutSwinging) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    LoadedBlock bar = pushed_bar(stepping), swinging = pushed_bar(stepping);
    bar.is_critically_damped = true;
    // `swinging` gives the rest shape to compare with. In a default run the implicit solver, which is slower,
    // skips this comparison; the tests of ImplicitBody compare its rest shape with the static one.
    const bool is_compared = stepping == Stepping::springs || is_full_run();
    for (int tick = 0; tick < 4000; ++tick) {
      bar.tick(0.0);
      if (is_compared) swinging.tick(20.0);
    }
    const double bent = tip_m(bar);
    EXPECT_GT(bent, 1e-3);
    if (is_compared) {
      EXPECT_NEAR(bent / tip_m(swinging), 1.0, 2e-3) << "both come to the same rest";
    }
    const double stored_j = 0.5 * bent * 5e-8 * bar.lattice.material().youngs_modulus_pa;
    bar.load({ForceLoad{{{1.0, 1.0}}, Vector3::Zero()}});
    double before = bent, most_j = 0.0;
    int ticks = 0;
    for (; ticks < 4000 && before > 0.01 * bent; ++ticks) {
      bar.tick(0.0);
      most_j = std::max(most_j, bar.kinetic_energy_j());
      const double now = tip_m(bar);
      ASSERT_LT(now, before + 2e-3 * bent) << ticks;
      before = now;
    }
    EXPECT_LT(ticks, 2000);
    EXPECT_LT(most_j, 0.15 * stored_j);
    for (int tick = 0; tick < 1000; ++tick) {
      bar.tick(0.0);
      ASSERT_GT(tip_m(bar), -0.01 * bent) << "does not swing past its rest";
    }
    EXPECT_NEAR(tip_m(bar), 0.0, 2e-3 * bent);
  }
}

// The tool presses the body and lets go.
TEST(Settling, AStrokeAllocatesNothingAndEndsAtRest) {
  Scene scene = small_handle();
  scene.bodies[0].material = silicone();
  scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  scene.sculpting.drag_per_s = 0.0;
  scene.sculpting.is_critically_damped = true;
  Simulation simulation = simulate(scene);
  simulation.advance(above(0.055, 0.0095));
  const std::size_t before = allocation_count();
  bool touched = false;
  for (int tick = 0; tick < 300; ++tick) {
    touched |= simulation.advance(above(0.055, 0.0095 - 2e-5 * tick)).touching;
  }
  for (int tick = 0; tick < 2000; ++tick) simulation.advance(above(0.055, 0.03));
  EXPECT_EQ(allocation_count(), before);
  EXPECT_TRUE(touched);
  const LatticeMesh& mesh = simulation.lattice().mesh();
  for (int n = 0; n < mesh.node_count(); ++n) EXPECT_LT(simulation.lattice().displacement(n).norm(), 1e-4);
}

}  // namespace
}  // namespace spoonbill
