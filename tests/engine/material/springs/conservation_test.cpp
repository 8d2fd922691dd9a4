// Tests that a free body conserves energy and momentum over a long time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/processor.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/statics/static_body.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

constexpr int ticks = 100000;

// `whole` is the energy T + V of the springs in double precision (T kinetic, V potential), `kept` is
// T + V - (h / 2) dV/dt. The symplectic Euler method with the step h conserves `kept` if the forces are
// linear. T + V itself oscillates by the fraction w h / 2 within a period of angular frequency w.
struct Energies {
  double whole = 0.0, kept = 0.0;
};
Energies energies_of(const SpringLattice& lattice, const StaticBody& springs, double h_s) {
  Energies energies;
  double by_force = 0.0;
  for (std::size_t cell = 0; cell < springs.cell_count(); ++cell) {
    CellMoves moves;
    for (std::size_t c = 0; c < 8; ++c) moves[c] = lattice.displacement(springs.cell_nodes(cell)[c]);
    const CellResponse response = springs.respond(cell, moves, Tangent::plain);
    energies.whole += response.energy_j;
    for (std::size_t c = 0; c < 8; ++c) {
      const Vector3 force = response.force_n.segment<3>(3 * static_cast<Eigen::Index>(c));
      by_force += force.dot(lattice.velocity(springs.cell_nodes(cell)[c]));
    }
  }
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    energies.whole += 0.5 * lattice.mass(n) * lattice.velocity(n).squaredNorm();
  }
  energies.kept = energies.whole - 0.5 * h_s * by_force;
  return energies;
}

// Returns a block whose nodes have random velocities of up to 2 mm/s along each axis. The block must stay
// near its origin, because displacements have only seven digits. If it moved away by thousands of times its
// deformation, rounding would add 5 % of its kinetic energy in thousands of ticks.
SpringLattice shaken_block(double damping_time_s) {
  Material material = elastic_material(5000.0, 0.35, 1000.0);
  material.damping_time_s = damping_time_s;
  SpringLattice lattice = block({0.009, 0.009, 0.015}, {4, 4, 6}, material);
  Random random(23);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    lattice.set_velocity(n,
                         2e-3 * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
  }
  return lattice;
}

TEST(Conservation, AFreeBodyKeepsEnergyAndMomentum) {
  const DenormalsFlushed flushed;
  SpringLattice lattice = shaken_block(0.0);
  const StaticBody springs =
      StaticBody::make(lattice.mesh(), elastic_material(5000.0, 0.35, 1000.0), CellKind::springs).value();
  RelaxSettings settings;
  settings.time_s = lattice.stable_step_s(0.5);
  const Momentum before = momentum_of(lattice);
  const double kept = energies_of(lattice, springs, settings.time_s).kept;
  double least = kept, most = kept;
  for (; settings.tick < ticks; ++settings.tick) {
    relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    if (settings.tick % 500 != 0) continue;
    const double now = energies_of(lattice, springs, settings.time_s).kept;
    least = std::min(least, now);
    most = std::max(most, now);
  }
  EXPECT_GT(least / kept, 0.99);
  EXPECT_LT(most / kept, 1.01);
  EXPECT_LT((momentum_of(lattice).sum - before.sum).norm(), 1e-5 * before.size);
}

TEST(Conservation, ADampedBodyNeverGains) {
  const DenormalsFlushed flushed;
  SpringLattice lattice = shaken_block(4e-5);
  const StaticBody springs =
      StaticBody::make(lattice.mesh(), elastic_material(5000.0, 0.35, 1000.0), CellKind::springs).value();
  RelaxSettings settings;
  settings.time_s = lattice.stable_step_s(0.4);
  double last = energies_of(lattice, springs, settings.time_s).kept;
  for (; settings.tick < ticks / 10; ++settings.tick) {
    relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    if (settings.tick % 20 != 0) continue;
    const double now = energies_of(lattice, springs, settings.time_s).kept;
    // The tolerance covers single-precision rounding, which dominates once the vibration is damped and the
    // block moves almost rigidly.
    EXPECT_LT(now, last * (1.0 + 1e-6)) << settings.tick;
    last = now;
  }
}

}  // namespace
}  // namespace spoonbill
