// Tests free bodies made of springs: a vibrating body keeps its energy, and two bodies that collide keep
// their momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/bspline/change_knots.h"
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

// Returns the same surface with twice as many polynomial pieces in both directions.
Surface with_finer_net(const Surface& surface) {
  Surface finer = surface;
  for (const Direction direction : {Direction::u, Direction::v}) {
    const KnotVector& knots = direction == Direction::u ? finer.u : finer.v;
    std::vector<double> middles;
    const std::vector<double> breaks = knots.breakpoints();
    for (std::size_t b = 1; b < breaks.size(); ++b) middles.push_back(0.5 * (breaks[b - 1] + breaks[b]));
    finer = convert_to_finer_knots(finer, direction, halve_pieces(knots, middles).value()).value();
  }
  return finer;
}

struct Balls {
  bool damped = true;
  int halvings = 1;  // of the surfaces' polynomial pieces; without any, nets cannot follow fine lattices
};

// Throws one ball off centre against another, in real time, from a direction.
Collision collide(int node_budget, const Balls& balls, const Quaternion& direction) {
  const DenormalsFlushed flushed;
  Material silicone = made_elastic(bundled_material("silicone-00-30"));
  if (!balls.damped) silicone.damping_time_s = 0.0;
  const SphereSize size{0.015};
  const auto ball = [&](const char* name, const Vector3& centre_m) {
    Body body = stock_body(name, size, centre_m, silicone, node_budget);
    for (int h = 0; h < balls.halvings; ++h) body.surface = with_finer_net(body.surface);
    return make_state(body);
  };
  Impact impact(ball("target", Vector3::Zero()), ball("thrown", direction * Vector3(0.004, 0.0302, 0.002)),
                Impact::Clock::real_time);
  const std::array<StaticBody, 2> springs = {
      StaticBody::make(impact.body(0).lattice.mesh(), silicone, CellKind::springs).value(),
      StaticBody::make(impact.body(1).lattice.mesh(), silicone, CellKind::springs).value()};
  impact.throw_at(1, direction * Vector3(0.0, -0.2, 0.0));
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

// Returns directions of collisions. The loss also depends on where nodes and samples happen to meet, so
// losses are compared by their mean over directions.
std::vector<Quaternion> collision_directions(int count) {
  std::vector<Quaternion> all;
  for (int i = 0; i < count; ++i) {
    all.push_back(Quaternion(Eigen::AngleAxisd(2.4 * i, Vector3::UnitZ()) *
                             Eigen::AngleAxisd(0.7 * i, Vector3::UnitX())));
  }
  return all;
}

struct Losses {
  double mean = 0.0, least = 1.0;
};

// Returns the losses of collisions in several directions, as fractions of the energy.
Losses find_losses(int node_budget, const Balls& balls) {
  const bool is_whole = find_skip_reason(ForceRun::whole_table).empty();
  const std::vector<Quaternion> directions = collision_directions(is_whole ? 8 : 3);
  const std::string what = std::to_string(node_budget) + " nodes" + (balls.damped ? "" : ", undamped");
  Losses losses;
  double momentum_change = 0.0;
  for (const Quaternion& direction : directions) {
    const Collision collision = collide(node_budget, balls, direction);
    EXPECT_TRUE(collision.touched && collision.parted) << what;
    losses.mean += collision.energy_lost / static_cast<double>(directions.size());
    losses.least = std::min(losses.least, collision.energy_lost);
    momentum_change = std::max(momentum_change, collision.momentum_change);
  }
  print_result("collision", what + ": change of momentum", momentum_change);
  print_result("collision", what + ": energy lost, mean", losses.mean);
  print_result("collision", what + ": energy lost, least", losses.least);
  EXPECT_LT(momentum_change, 1e-5) << what;
  return losses;
}

std::vector<int> collision_budgets() {
  const bool is_whole = find_skip_reason(ForceRun::whole_table).empty();
  return is_whole ? std::vector<int>{150, 300, 500, 800, 1500, 2500} : std::vector<int>{150, 500};
}

TEST(FreeCollision, KeepsMomentumAndLosesLessEnergyWithSmallerCells) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  double last = 1.0;
  for (const int node_budget : collision_budgets()) {
    const Losses losses = find_losses(node_budget, {.damped = true});
    EXPECT_GT(losses.least, 0.0) << node_budget;
    EXPECT_LT(losses.mean, last) << node_budget;
    last = losses.mean;
  }
}

// Without damping, only contact takes energy. Contacts whose gaps do not follow the lattices, and springs
// whose forces do not follow their lengths, would add energy, which no damping would take away. A single
// collision may gain 0.3 %.
TEST(FreeCollision, GainsNoEnergyWithoutDamping) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  for (const int node_budget : collision_budgets()) {
    const Losses losses = find_losses(node_budget, {.damped = false});
    EXPECT_GT(losses.mean, 0.0) << node_budget;
    EXPECT_LT(losses.mean, 0.05) << node_budget;
    EXPECT_GT(losses.least, -0.003) << node_budget;
  }
}

// The surface folds beside the pole where these balls meet, because its control net is coarser than its
// lattice. Points outside then seem to be deep inside.
TEST(FreeCollision, StaysBoundedWhereASurfaceFolds) {
  const Collision collision = collide(500, {.damped = false, .halvings = 0}, collision_directions(6)[5]);
  EXPECT_TRUE(collision.touched && collision.parted);
  EXPECT_NEAR(collision.energy_lost, 0.0, 0.05);
}

// Here a surface folds for one tick, and a point outside seems to be 0.7 cells deep. If it were pushed out,
// the collision would gain 1.3 %.
TEST(FreeCollision, GainsNoEnergyWhereASurfaceFoldsForATick) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  const Collision collision = collide(2500, {.damped = false, .halvings = 2}, collision_directions(5)[4]);
  EXPECT_TRUE(collision.touched && collision.parted);
  EXPECT_GT(collision.energy_lost, -0.003);
  EXPECT_LT(collision.energy_lost, 0.05);
}

}  // namespace
}  // namespace spoonbill
