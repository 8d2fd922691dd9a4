#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/material/lattice_solver.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

// The fastest mode of the lattice, normalised by mass, and its angular frequency.
struct Mode {
  std::vector<Vector3> shape;
  double omega = 0.0;
};

Mode fastest_mode(SpringLattice& lattice) {
  const LatticeView view = lattice.view();
  Mode mode;
  double square = 0.0;
  for (int step = 0; step < 2000; ++step) square = lattice.kernels().power_step(view, lattice.free_mass());
  mode.omega = std::sqrt(square);
  double norm = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    mode.shape.emplace_back(view.power_x[n], view.power_y[n], view.power_z[n]);
    norm += lattice.mass(n) * mode.shape.back().squaredNorm();
  }
  for (Vector3& node : mode.shape) node /= std::sqrt(norm);
  return mode;
}

double amplitude(const SpringLattice& lattice, const Mode& mode, bool of_velocity) {
  double sum = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    sum += lattice.mass(n) * mode.shape[n].dot(of_velocity ? lattice.velocity(n) : lattice.displacement(n));
  }
  return sum;
}

// Returns one cell. At its Poisson's ratio of 1/4 it has no volume force, so all of its stiffness comes from
// springs and is damped.
SpringLattice one_cell(double damping_time_s) {
  Material material = elastic_material(5000.0, 0.25, 1000.0);
  material.damping_time_s = damping_time_s;
  return block({2e-3, 2e-3, 2e-3}, {2, 2, 2}, material);
}

// Displaces the lattice by the mode, with an amplitude so small that the springs are linear to 1e-5.
void excite(SpringLattice& lattice, const Mode& mode) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) lattice.set_displacement(n, 2e-11 * mode.shape[n]);
}

// Returns the largest stable step of symplectic Euler for x'' + 2 z w x' + w^2 x = 0, where w is `omega`.
double stability_limit_s(double omega, double z) {
  return 2.0 / omega * (std::sqrt(1.0 + z * z) - z);
}

// The stability limit of a lattice is that of its fastest mode, to a thousandth.
TEST(Integration, StabilityFlipsAtTheLimit) {
  SpringLattice undamped = one_cell(0.0);
  const double undamped_omega = fastest_mode(undamped).omega;
  for (const double z : {0.0, 0.05, 0.2, 0.5, 1.0, 2.0}) {
    for (const double share : {0.999, 1.001}) {
      SpringLattice lattice = one_cell(2.0 * z / undamped_omega);
      const Mode mode = fastest_mode(lattice);
      excite(lattice, mode);
      const double limit_s = stability_limit_s(mode.omega, z);
      EXPECT_NEAR(lattice.stable_step_s(1.0) / limit_s, 1.0, 1e-3) << z;
      const auto h = static_cast<float>(share * limit_s);
      double first = 0.0, last = 0.0;
      for (int step = 0; step < 6000; ++step) {
        plain_substep(lattice, h);
        const double energy =
            std::abs(amplitude(lattice, mode, false)) + std::abs(amplitude(lattice, mode, true)) / mode.omega;
        if (step < 100) first = std::max(first, energy);
        if (step >= 5900) last = std::max(last, energy);
        if (last > 0.0 || energy > 1e3 * first) last = std::max(last, energy);
        if (last > 10.0 * first) break;
      }
      EXPECT_EQ(last > 3.0 * first, share > 1.0)
          << "z " << z << " share " << share << " first " << first << " last " << last;
    }
  }
}

// A kick followed by a drift (symplectic Euler with step h) conserves v^2 + w^2 x^2 - h w^2 x v at the
// angular frequency w. The test checks this for the formula in double precision and for the lattice.
TEST(Integration, KickDriftConservesItsOwnEnergy) {
  const double omega = 7.0, h = 0.02;
  double x = 1.0, v = 0.5;
  const double start = v * v + omega * omega * x * x - h * omega * omega * x * v;
  for (int step = 0; step < 100000; ++step) {
    v -= h * omega * omega * x;
    x += h * v;
  }
  EXPECT_NEAR((v * v + omega * omega * x * x - h * omega * omega * x * v) / start, 1.0, 1e-11);

  SpringLattice lattice = one_cell(0.0);
  const Mode mode = fastest_mode(lattice);
  excite(lattice, mode);
  const double step_s = 0.2 / mode.omega;
  const auto conserved = [&] {
    const double q = amplitude(lattice, mode, false), p = amplitude(lattice, mode, true),
                 w2 = mode.omega * mode.omega;
    return p * p + w2 * q * q - static_cast<double>(static_cast<float>(step_s)) * w2 * q * p;
  };
  const double before = conserved();
  for (int step = 0; step < 10000; ++step) {
    plain_substep(lattice, static_cast<float>(step_s));
    // The bound of 1e-3 allows for the rounding of ten thousand steps in single precision.
    ASSERT_NEAR(conserved() / before, 1.0, 1e-3) << step;
  }
}

// With a damping time t, the energy of a mode of angular frequency w decays as exp(-t w^2 s) in the time s.
TEST(Integration, AModeDecaysByItsDampingTime) {
  SpringLattice undamped = one_cell(0.0);
  const double omega = fastest_mode(undamped).omega;
  constexpr double loss_factor = 0.02;
  SpringLattice lattice = one_cell(loss_factor / omega);
  const Mode mode = fastest_mode(lattice);
  excite(lattice, mode);
  const double step_s = 0.02 / mode.omega;
  const auto energy = [&] {
    const double q = mode.omega * amplitude(lattice, mode, false), p = amplitude(lattice, mode, true);
    return p * p + q * q - step_s * mode.omega * q * p;
  };
  const double before = energy();
  for (int step = 0; step < 5000; ++step) plain_substep(lattice, static_cast<float>(step_s));
  EXPECT_NEAR(energy() / before, std::exp(-100.0 * loss_factor), 0.01);
}

TEST(Integration, FreeFallIsTheSumOfItsSteps) {
  SpringLattice lattice = block({8e-3, 8e-3, 8e-3}, {5, 5, 5}, elastic_material(100.0, 0.25, 1000.0));
  ContactConstraints none(1);
  ToolState tool;
  RelaxSettings settings;
  const Vector3 gravity_m_per_s2{0.0, -9.81, 0.0};
  for (int tick = 0; tick < 1000; ++tick) {
    const RelaxReport report = relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings,
                                     std::array{TouchingTool{ToolMotion{}, &tool, &none}});
    ASSERT_EQ(report.substeps, 1);
    ASSERT_FALSE(report.speed_capped);
  }
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    // The fall is -g h^2 n (n + 1) / 2, within the rounding of a thousand sums in single precision.
    EXPECT_NEAR(lattice.displacement(n).y(), -4.909905, 5e-5);
  }
}

// Supports the nodes at y = 0 from below, without friction.
void support_from_below(SpringLattice& lattice, ContactConstraints& contacts) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.mesh().nodes[n].y() > 1e-9) continue;
    EmbeddedPoint point;
    point.count = 1;
    point.node[0] = n;
    point.weight[0] = 1.0f;
    contacts.add_plane_push(0, lattice, point, Vector3::UnitY(), 0.0, n);
  }
}

// Returns the fraction of the top's area that a node represents.
double area_share(const LatticeMesh& mesh, int i, int k) {
  const double across = i == 0 || i == mesh.count[0] - 1 ? 0.5 : 1.0;
  const double along = k == 0 || k == mesh.count[2] - 1 ? 0.5 : 1.0;
  return across * along / ((mesh.count[0] - 1) * (mesh.count[2] - 1));
}

// The top of a block of height H on a slipping base sinks by rho g H^2 / 2 E, as a mean weighted by area, at
// any resolution and Poisson's ratio.
TEST(Integration, SelfWeightOnASlippingBase) {
  const double height = 0.02, modulus = 5000.0, density = 1050.0, gravity = 9.81e-3;
  const double expected = density * gravity * height * height / (2.0 * modulus);
  for (const int count : {5, 9}) {
    for (const double nu : {0.25, 0.45}) {
      SpringLattice lattice =
          block({height, height, height}, {count, count, count}, elastic_material(modulus, nu, density));
      ContactConstraints contacts(count * count);
      support_from_below(lattice, contacts);
      ToolState tool;
      RelaxSettings settings;
      settings.time_s = 2e-4;
      settings.drag_per_s = 300.0;
      const Vector3 gravity_m_per_s2{0.0, -gravity, 0.0};
      for (int tick = 0; tick < 1500; ++tick) {
        relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings,
              std::array{TouchingTool{ToolMotion{}, &tool, &contacts}});
      }
      double drop = 0.0;
      const LatticeMesh& mesh = lattice.mesh();
      for (int i = 0; i < count; ++i) {
        for (int k = 0; k < count; ++k) {
          drop -= area_share(mesh, i, k) * lattice.displacement(mesh.index(i, count - 1, k)).y();
        }
      }
      // The bound is 1 %, because volume strains of 1e-6 are close to the rounding of single precision.
      EXPECT_NEAR(drop / expected, 1.0, 0.01) << count << " nodes, nu " << nu;
    }
  }
}

// A bar of stiffness E A / L = 50 N/m hangs from contacts without friction at its top. A weight of 10 g pulls
// its lower end down by 1.962 mm.
TEST(Integration, HangingWeight) {
  const double length = 1.0, side = 0.02, stiffness = 50.0;
  SpringLattice lattice = block({side, length, side}, {2, 51, 2},
                                elastic_material(stiffness * length / (side * side), 0.25, 100.0));
  ContactConstraints contacts(4);
  const LatticeMesh& mesh = lattice.mesh();
  for (const int corner :
       {mesh.index(0, 50, 0), mesh.index(1, 50, 0), mesh.index(0, 50, 1), mesh.index(1, 50, 1)}) {
    EmbeddedPoint point;
    point.count = 1;
    point.node[0] = corner;
    point.weight[0] = 1.0f;
    contacts.add_plane_push(0, lattice, point, Vector3::UnitY(), 0.0, corner);
  }
  for (const int corner :
       {mesh.index(0, 0, 0), mesh.index(1, 0, 0), mesh.index(0, 0, 1), mesh.index(1, 0, 1)}) {
    lattice.set_node_force(corner, {0.0, -0.25 * 0.010 * 9.81, 0.0});
  }
  ToolState tool;
  RelaxSettings settings;
  settings.time_s = 3e-4;
  settings.drag_per_s = 60.0;
  ToolMotion at_top;
  at_top.start_m = at_top.end_m = {0.0, length, 0.0};
  for (int tick = 0; tick < 4000; ++tick) {
    relax(std::array{RelaxedLattice{&lattice}}, settings, std::array{TouchingTool{at_top, &tool, &contacts}});
  }
  EXPECT_NEAR(lattice.displacement(mesh.index(0, 0, 0)).y(), -1.962e-3,
              0.01e-3);  // the bound allows for the square of a strain of 0.2 %
}

// A block slides down an incline with the acceleration a = g (sin t - mu cos t).
TEST(Integration, BlockSlidesDownAnIncline) {
  for (const double friction : {0.0, 0.1, 0.3}) {
    const double tilt = 0.35, g = 9.81;
    Material material = elastic_material(2e4, 0.3, 1000.0);
    material.damping_time_s = 7e-5;
    material.friction = friction;
    SpringLattice lattice = block({0.02, 0.01, 0.02}, {5, 3, 5}, material);
    ContactConstraints contacts(25);
    support_from_below(lattice, contacts);
    ToolState tool;
    RelaxSettings settings;
    const Vector3 gravity_m_per_s2{g * std::sin(tilt), -g * std::cos(tilt), 0.0};
    const ToolMotion ground;
    const auto speed = [&] {
      double sum = 0.0, mass = 0.0;
      for (int n = 0; n < lattice.mesh().node_count(); ++n) {
        sum += lattice.mass(n) * lattice.velocity(n).x();
        mass += lattice.mass(n);
      }
      return sum / mass;
    };
    for (int tick = 0; tick < 200; ++tick) {
      relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings,
            std::array{TouchingTool{ground, &tool, &contacts}});
    }
    const double before = speed();
    for (int tick = 0; tick < 500; ++tick) {
      relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings,
            std::array{TouchingTool{ground, &tool, &contacts}});
    }
    const double expected = g * (std::sin(tilt) - friction * std::cos(tilt));
    EXPECT_NEAR((speed() - before) / 0.5, expected, 0.02 * g)
        << "friction " << friction;  // the bound allows for remaining oscillations of the block
  }
}

TEST(Integration, HeldNodesDoNotMoveAtAll) {
  SpringLattice lattice = block({0.02, 0.01, 0.02}, {5, 3, 5}, elastic_material(500.0, 0.45, 1000.0));
  std::vector<std::uint8_t> held(75, 0);
  for (int n = 0; n < 15; ++n) held[static_cast<std::size_t>(n)] = 1;
  lattice.fix_nodes(held);
  ContactConstraints none(1);
  ToolState tool;
  RelaxSettings settings;
  const Vector3 gravity_m_per_s2{3.0, -9.81, 2.0};
  for (int tick = 0; tick < 500; ++tick) {
    relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings,
          std::array{TouchingTool{ToolMotion{}, &tool, &none}});
  }
  for (int n = 0; n < 15; ++n) EXPECT_EQ(lattice.displacement(n), Vector3::Zero());
  EXPECT_LT(lattice.displacement(74).y(), -1e-5);
}

// A block of 8 x 8 x 16 mm that is stretched by 8 %, held at its ends, and released.
class StretchedBlock {
 public:
  explicit StretchedBlock(const Material& material)
      : lattice_(block({0.008, 0.008, length_m}, {5, 5, 9}, material)),
        ends_(static_cast<std::size_t>(lattice_.mesh().node_count()), 0) {
    const LatticeMesh& mesh = lattice_.mesh();
    for (int n = 0; n < mesh.node_count(); ++n) {
      const double z = mesh.nodes[n].z();
      if (z < 1e-6 || z > length_m - 1e-6) ends_[static_cast<std::size_t>(n)] = 1;
      lattice_.set_displacement(n, {0.0, 0.0, strain * z});
    }
    lattice_.fix_nodes(ends_);
    settings_.drag_per_s = 60.0;
  }

  void relax_for(std::uint64_t ticks) {
    for (const std::uint64_t end = settings_.tick + ticks; settings_.tick < end; ++settings_.tick) {
      relax(std::array{RelaxedLattice{&lattice_}}, settings_,
            std::array{TouchingTool{ToolMotion{}, &tool_, &none_}});
    }
  }
  void let_go() { lattice_.fix_nodes(std::vector<std::uint8_t>(ends_.size(), 0)); }

  // Returns the fraction of the initial stretch that remains.
  double kept() const {
    const LatticeMesh& mesh = lattice_.mesh();
    const double length =
        (lattice_.position(mesh.index(2, 2, 8)) - lattice_.position(mesh.index(2, 2, 0))).norm();
    return (length / length_m - 1.0) / strain;
  }
  // Returns the creep strain in the centre, along the block, as a fraction of the strain there.
  double crept() {
    constexpr int along = 2;  // direction of springs from a node to the next node along k
    const LatticeMesh& mesh = lattice_.mesh();
    const int node = mesh.index(2, 2, 4), next = mesh.index(2, 2, 5);
    const double strain_there = (lattice_.position(next) - lattice_.position(node)).norm() /
                                    (mesh.nodes[next] - mesh.nodes[node]).norm() -
                                1.0;
    return lattice_.view().springs[along].crept[node] / strain_there;
  }
  double volume_ratio() const { return lattice_.volume_m3() / lattice_.rest_volume_m3(); }

  static constexpr double strain = 0.08;

 private:
  static constexpr double length_m = 0.016;

  SpringLattice lattice_;
  std::vector<std::uint8_t> ends_;
  ContactConstraints none_{1};
  ToolState tool_;
  RelaxSettings settings_;
};

Material clay_of(double hardening) {
  Material material = elastic_material(500.0, 0.45, 1500.0);
  material.plastic = true;
  material.yield_strain = 0.005;
  material.flow_rate_per_s = 50.0;
  material.hardening = hardening;
  return material;
}

// Plastic strain remains after release, elastic strain does not.
TEST(Integration, ClayKeepsAStretchAndRubberDoesNot) {
  const auto kept_after = [](StretchedBlock& stretched) {
    stretched.relax_for(1000);
    stretched.let_go();
    stretched.relax_for(1500);
    return stretched.kept();
  };
  StretchedBlock clay(clay_of(0.0)), rubber(elastic_material(500.0, 0.45, 1500.0)), hard(clay_of(0.5));
  const double of_clay = kept_after(clay), of_hard = kept_after(hard);
  EXPECT_GT(of_clay, 0.75);
  EXPECT_NEAR(clay.volume_ratio(), 1.0, 0.002);
  EXPECT_LT(std::abs(kept_after(rubber)), 0.01);
  // Clay with a hardening of 0.5 yields until strain - p = 0.005 + 0.5 p, where p is the plastic strain. It
  // keeps two thirds of what clay without hardening keeps.
  EXPECT_NEAR(of_hard / of_clay, 1.0 / 1.5, 0.05);
}

// A gel that is held stretched creeps: with its relaxation time as the time constant, the creep strain
// approaches the relaxing fraction of the strain. After release, the gel springs back with the longer time
// constant of a standard linear solid.
TEST(Integration, GelCreepsAsItsRelaxationTimeSays) {
  Material gel = elastic_material(500.0, 0.45, 1000.0);
  gel.relaxing_fraction = 0.6;
  gel.relaxation_time_s = 0.5;
  StretchedBlock stretched(gel);
  stretched.relax_for(500);
  const double once = stretched.crept();
  stretched.relax_for(2000);
  const double all = stretched.crept();
  // Each spring creeps once per tenth of a second, which is a fifth of the time constant. With such steps the
  // implicit Euler method lags by a tenth.
  EXPECT_NEAR(once / all, 1.0 - std::exp(-1.0), 0.08);
  // The strain that changes the volume does not creep.
  EXPECT_NEAR(all, 0.6, 0.03);
  EXPECT_NEAR(stretched.volume_ratio(), 1.0, 0.02);
  stretched.let_go();
  // A standard linear solid springs back with a longer time constant: the relaxation time divided by the
  // fraction of the stiffness that remains.
  const double back_s = gel.relaxation_time_s / (1.0 - gel.relaxing_fraction);
  stretched.relax_for(500);
  EXPECT_NEAR(stretched.kept(), 0.6 * std::exp(-0.5 / back_s), 0.06);
  stretched.relax_for(5500);
  EXPECT_NEAR(stretched.kept(), 0.6 * std::exp(-6.0 / back_s), 0.01);
}

}  // namespace
}  // namespace spoonbill
