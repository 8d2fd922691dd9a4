// Tests free bodies made of springs: a vibrating body keeps its energy, and two bodies that collide keep
// their momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/material/statics/static_body.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/simulation/impact.h"

namespace spoonbill {
namespace {

BodyState make_state(const Body& body) {
  return make_body_state(body, {}, InstructionSet::baseline).value();
}

// Returns the kinetic energy of a lattice that moves in real time, in joules.
double kinetic_energy_j(const SpringLattice& lattice) {
  double energy = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    energy += 0.5 * static_cast<double>(lattice.mass(n)) * lattice.velocity(n).squaredNorm();
  }
  return energy;
}

struct Potential {
  double energy_j = 0.0;
  double power_w = 0.0;  // rate of change of the energy
};

Potential find_potential(const SpringLattice& lattice, const StaticBody& springs) {
  Potential sum;
  for (std::size_t cell = 0; cell < springs.cell_count(); ++cell) {
    const std::array<int, 8>& nodes = springs.cell_nodes(cell);
    CellMoves moves;
    for (std::size_t c = 0; c < 8; ++c) moves[c] = lattice.displacement(nodes[c]);
    const CellResponse response = springs.respond(cell, moves, Tangent::plain);
    sum.energy_j += response.energy_j;
    for (std::size_t c = 0; c < 8; ++c) {
      sum.power_w +=
          response.force_n.segment<3>(3 * static_cast<Eigen::Index>(c)).dot(lattice.velocity(nodes[c]));
    }
  }
  return sum;
}

// Returns T + V - (h / 2) dV/dt, where T is the kinetic and V the potential energy. The symplectic Euler
// method (a kick, then a drift) with the step h conserves this value up to the order of h^2.
double conserved_energy_j(const SpringLattice& lattice, const StaticBody& springs, double step_s) {
  const Potential potential = find_potential(lattice, springs);
  return kinetic_energy_j(lattice) + potential.energy_j - 0.5 * step_s * potential.power_w;
}

// At large strains the energy changes because the springs are linearised only once a tick; at very small
// strains it changes because of single precision.
TEST(Ringing, KeepsItsEnergyWithoutDamping) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  const DenormalsFlushed flushed;
  constexpr double speed_m_per_s = 0.005;
  constexpr int step_divisor = 3;
  const bool is_full = find_skip_reason(ForceRun::full).empty();
  for (const char* material : {"gelatin-20-1", "silicone-00-30", "foam"}) {
    const CylinderSize size{0.006, 0.06, 0.001};
    Body body = stock_body("rod", size, Vector3::Zero(), made_elastic(bundled_material(material)), 300);
    body.material.damping_time_s = 0.0;
    BodyState state = make_state(body);
    SpringLattice& lattice = state.lattice;
    const StaticBody springs =
        StaticBody::make(lattice.mesh(), lattice.materials(), CellKind::springs).value();
    RelaxSettings settings;
    settings.substeps =
        step_divisor *
        static_cast<int>(std::lround(settings.time_s / lattice.find_real_time_step_s(settings.time_s)));
    const double step_s = settings.time_s / settings.substeps;
    lattice.set_inertia(1.0, step_s);
    // The rod starts to swing in approximately its first bending mode, and to vibrate along its length.
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      const double along = lattice.mesh().nodes[static_cast<std::size_t>(n)].y() / size.height_m;
      lattice.set_velocity(n, speed_m_per_s * Vector3(std::cos(2.0 * std::numbers::pi * along), along, 0.0));
    }
    const double before = conserved_energy_j(lattice, springs, step_s);
    double least = before, most = before, least_kinetic = kinetic_energy_j(lattice);
    for (; settings.tick < (is_full ? 1000u : 300u); ++settings.tick) {
      EXPECT_EQ(relax(std::array{RelaxedLattice{&lattice}}, settings, {}).substeps, settings.substeps);
      const double now = conserved_energy_j(lattice, springs, step_s);
      least = std::min(least, now);
      most = std::max(most, now);
      least_kinetic = std::min(least_kinetic, kinetic_energy_j(lattice));
    }
    print_result("ringing", std::string(material) + ": largest change of energy",
                 std::max(most / before - 1.0, 1.0 - least / before));
    EXPECT_LT(least_kinetic, 0.9 * before) << material << " does not ring";
    EXPECT_LT(most / before, 1.001) << material;
    EXPECT_GT(least / before, 0.999) << material;
    if (!is_full) break;
  }
}

Vector3 momentum_ns(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    sum += static_cast<double>(lattice.mass(n)) * lattice.velocity(n);
  }
  return sum;
}

struct Collision {
  double momentum_change = 0.0;  // relative to the momentum of the thrown body
  double energy_lost = 0.0;      // as a fraction of the energy before the collision
  bool touched = false, parted = false;
};

double whole_energy_j(const BodyState& body, const StaticBody& springs) {
  return kinetic_energy_j(body.lattice) + find_potential(body.lattice, springs).energy_j;
}

// Throws one ball off centre against another, in real time.
Collision collide(int node_budget, bool is_damped) {
  const DenormalsFlushed flushed;
  Material silicone = made_elastic(bundled_material("silicone-00-30"));
  if (!is_damped) silicone.damping_time_s = 0.0;
  const SphereSize size{0.015};
  Impact impact(make_state(stock_body("target", size, Vector3::Zero(), silicone, node_budget)),
                make_state(stock_body("thrown", size, {0.004, 0.0302, 0.002}, silicone, node_budget)),
                Impact::Clock::real_time);
  const std::array<StaticBody, 2> springs = {
      StaticBody::make(impact.body(0).lattice.mesh(), silicone, CellKind::springs).value(),
      StaticBody::make(impact.body(1).lattice.mesh(), silicone, CellKind::springs).value()};
  impact.throw_at(1, {0.0, -0.2, 0.0});
  const auto energy_j = [&] {
    return whole_energy_j(impact.body(0), springs[0]) + whole_energy_j(impact.body(1), springs[1]);
  };
  const auto sum = [&] {
    return Vector3(momentum_ns(impact.body(0).lattice) + momentum_ns(impact.body(1).lattice));
  };
  const Vector3 before = sum();
  const double energy_before_j = energy_j();
  Collision collision;
  for (int tick = 0; tick < 200; ++tick) {
    const bool touches = impact.tick();
    collision.touched |= touches;
    collision.parted = !touches;
  }
  collision.momentum_change = (sum() - before).norm() / before.norm();
  collision.energy_lost = 1.0 - energy_j() / energy_before_j;
  return collision;
}

// Numbers of nodes for which collisions are tried. From one to the next, cells shrink to 0.6 or 0.7 of their
// size, because the loss also depends on where nodes happen to meet: at 500 nodes it is lower than at 800.
std::vector<int> collision_budgets() {
  const bool is_whole = find_skip_reason(ForceRun::whole_table).empty();
  return is_whole ? std::vector<int>{150, 800, 2500} : std::vector<int>{150, 500};
}

TEST(FreeCollision, KeepsMomentumAndLosesLessEnergyWithSmallerCells) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  double last = 2.0;
  for (const int node_budget : collision_budgets()) {
    const Collision collision = collide(node_budget, true);
    const std::string what = std::to_string(node_budget) + " nodes";
    print_result("collision", what + ": change of momentum", collision.momentum_change);
    print_result("collision", what + ": energy lost", collision.energy_lost);
    EXPECT_TRUE(collision.touched && collision.parted) << what;
    EXPECT_LT(collision.momentum_change, 1e-5) << what;
    EXPECT_LT(collision.energy_lost, last) << what;
    last = collision.energy_lost;
  }
}

// Without damping, only contact takes energy. Contacts whose gaps do not follow the lattices, and springs
// whose forces do not follow their lengths, would add energy, which no damping would take away. The control
// nets of the balls are coarser than their lattices.
TEST(FreeCollision, NeverGainsEnergyWithoutDamping) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  std::vector<int> budgets = collision_budgets();
  budgets.push_back(1500);
  for (const int node_budget : budgets) {
    const Collision collision = collide(node_budget, false);
    const std::string what = std::to_string(node_budget) + " nodes";
    print_result("collision", what + ", undamped: energy lost", collision.energy_lost);
    EXPECT_TRUE(collision.touched && collision.parted) << what;
    EXPECT_GT(collision.energy_lost, 0.0) << what;
    EXPECT_LT(collision.energy_lost, 0.05) << what;
  }
}

}  // namespace
}  // namespace spoonbill
