#include "engine/material/springs/lattice_forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/material/cells/spring_cell.h"
#include "engine/material/lattice_solver.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

void displace_at_random(SpringLattice& lattice, double amplitude_m, std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    lattice.set_displacement(
        n, amplitude_m * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
  }
}

double volume_energy(const SpringLattice& lattice, double bulk_pa) {
  CellCorners corners;
  for (int c = 0; c < 8; ++c) corners[c] = lattice.position(c);
  const double rest = lattice.rest_volume_m3();
  const double strain = cell_volume(corners) / rest - 1.0;
  return 0.5 * bulk_pa * strain * strain * rest;
}

TEST(LatticeForces, VolumeForceIsTheGradientOfItsEnergy) {
  const double bulk = bulk_stiffness(5000.0, 0.45);
  SpringLattice lattice = block({1e-3, 1.1e-3, 0.9e-3}, {2, 2, 2}, elastic_material(5000.0, 0.45, 1000.0));
  displace_at_random(lattice, 1e-4, 7);
  const LatticeView view = lattice.view();
  lattice.kernels().start_forces(view);  // sets forces to 0, because the springs were linearised at rest
  lattice.kernels().volume_forces(view);
  const float* force[3] = {view.fx, view.fy, view.fz};
  double largest = 0.0;
  for (int n = 0; n < 8; ++n) largest = std::max(largest, static_cast<double>(std::abs(view.fx[n])));
  for (int n = 0; n < 8; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 at = lattice.displacement(n);
      Vector3 step = Vector3::Zero();
      step[axis] = 1e-7;
      SpringLattice moved = lattice;
      moved.set_displacement(n, at + step);
      const double up = volume_energy(moved, bulk);
      moved.set_displacement(n, at - step);
      const double gradient = (up - volume_energy(moved, bulk)) / 2e-7;
      // The bound of 1e-3 allows for single precision of the displaced nodes divided by the difference step.
      EXPECT_NEAR(force[axis][n], -gradient, 1e-3 * largest);
    }
  }
}

TEST(LatticeForces, ForcesOfAFreeBodySumToNothing) {
  SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, elastic_material(5000.0, 0.49, 1000.0));
  displace_at_random(lattice, 2e-4, 11);
  const LatticeView view = lattice.view();
  take_forces(lattice, 0.0f);
  double sum = 0.0, magnitude = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    sum += view.fx[n];
    magnitude += std::abs(view.fx[n]);
  }
  EXPECT_LT(std::abs(sum), 1e-5 * magnitude);  // the bound allows for rounding of sums in single precision
}

TEST(LatticeForces, RestShapeFeelsExactlyNothing) {
  SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, elastic_material(5000.0, 0.25, 1000.0));
  const LatticeView view = lattice.view();
  take_forces(lattice, 1e-4f);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    EXPECT_EQ(view.fx[n], 0.0f);
    EXPECT_EQ(view.fy[n], 0.0f);
    EXPECT_EQ(view.fz[n], 0.0f);
  }
}

// A damper on the full relative velocity of a spring's ends would brake a rigid rotation. The lattice's
// damping does not.
TEST(LatticeForces, RigidRotationProducesNoDamping) {
  SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, elastic_material(5000.0, 0.45, 1000.0));
  const Vector3 spin(3.0, -2.0, 5.0);
  const Eigen::AngleAxisd turned(0.8, Vector3(1, 2, 3).normalized());
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const Vector3 position = turned * lattice.mesh().nodes[n];
    lattice.set_displacement(n, position - lattice.mesh().nodes[n]);
    lattice.set_velocity(n, spin.cross(position));
  }
  const float tau = 1e-3f;
  take_forces(lattice, tau);
  const LatticeView view = lattice.view();
  double power = 0.0, whole_damper = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    power += lattice.velocity(n).dot(Vector3(view.fx[n], view.fy[n], view.fz[n]));
    for (const SpringArrays& s : view.springs) {
      if (s.stiffness[n] == 0.0f) continue;
      const Vector3 apart = lattice.velocity(n + s.offset) - lattice.velocity(n);
      whole_damper += static_cast<double>(s.stiffness[n] * tau) * apart.squaredNorm();
    }
  }
  // The bound allows for single precision of the positions. The forces are those of the shape expected after
  // the time tau, whose error (tau w)^2 / 2 at the spin w is only 2e-5.
  EXPECT_LT(std::abs(power), 1e-3 * whole_damper);
}

// The even growth of a block is damped by its springs alone. The forces that oppose a change of volume have
// no damping.
TEST(LatticeForces, OnlySpringsAreDamped) {
  SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, elastic_material(5000.0, 0.45, 1000.0));
  for (int n = 0; n < lattice.mesh().node_count(); ++n) lattice.set_velocity(n, lattice.mesh().nodes[n]);
  const LatticeView view = lattice.view();
  lattice.kernels().linearise_springs(view, 1e-3f, Linearised::tangents);
  lattice.kernels().start_forces(view);
  const std::vector<float> of_springs(view.fx, view.fx + view.padded_count);
  EXPECT_GT(of_springs[0], 0.0f);
  lattice.kernels().volume_forces(view);
  EXPECT_EQ(std::vector<float>(view.fx, view.fx + view.padded_count), of_springs);
}

// Drag slows a velocity but takes nothing from the impulse of a force.
TEST(LatticeForces, AKickAddsTheWholeImpulse) {
  SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {2, 2, 2}, elastic_material(5000.0, 0.25, 1000.0));
  lattice.set_velocity(0, {2.0, 0.0, 0.0});
  const LatticeView view = lattice.view();
  std::fill_n(view.fx, view.padded_count, 1e-3f);
  lattice.kernels().kick(view, 1e-3f, 0.5f);
  const double gained = 1e-6 / static_cast<double>(lattice.mass(0));
  EXPECT_NEAR(lattice.velocity(0).x(), 1.0 + gained, 1e-6);
  EXPECT_NEAR(lattice.velocity(1).x(), gained, 1e-6 * gained);
}

// One pass over the springs gives the same bits as a linearisation followed by a step of the power iteration.
// If the new derivatives are not to be stored, the pass leaves the previous ones unchanged.
TEST(LatticeForces, PowerStepsAlongWithALinearisation) {
  for (const double stiffening : {0.0, 20.0, -20.0}) {
    Material material = elastic_material(5000.0, 0.3, 1000.0);
    material.stiffening = stiffening;
    const SpringLattice at_rest = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, material);
    const auto followed = [&](const auto& step) {
      SpringLattice lattice = at_rest;
      displace_at_random(lattice, 2e-4, 5);
      const LatticeView view = lattice.view();
      std::vector<float> out = {step(lattice, view)};
      for (const float* field : {view.spring_x, view.spring_y, view.spring_z, view.power_x, view.power_y,
                                 view.power_z, view.reference_x, view.moved_x}) {
        out.insert(out.end(), field, field + view.padded_count);
      }
      for (const SpringArrays& s : view.springs) {
        out.insert(out.end(), s.tangent, s.tangent + tangent_runs * view.padded_count);
      }
      return out;
    };
    const auto one_by_one = followed([](SpringLattice& lattice, const LatticeView& view) {
      lattice.kernels().linearise_springs(view, 0.0f, Linearised::tangents);
      return lattice.kernels().power_step(view, lattice.free_mass());
    });
    const auto at_once = followed([](SpringLattice& lattice, const LatticeView& view) {
      return lattice.kernels().linearise_with_power_step(view, 0.0f, Linearised::tangents,
                                                         lattice.free_mass());
    });
    const auto forgetting = followed([](SpringLattice& lattice, const LatticeView& view) {
      return lattice.kernels().linearise_with_power_step(view, 0.0f, Linearised::forces, lattice.free_mass());
    });
    EXPECT_GT(one_by_one[0], 0.0f);
    EXPECT_EQ(one_by_one, at_once);
    const std::size_t kept = 1 + 8 * static_cast<std::size_t>(SpringLattice(at_rest).view().padded_count);
    EXPECT_TRUE(
        std::equal(at_once.begin(), at_once.begin() + static_cast<std::ptrdiff_t>(kept), forgetting.begin()));
    EXPECT_NE(at_once, forgetting);
  }
}

// Forces linearised at a strained shape are exact to first order: half the step gives a quarter of the error.
TEST(LatticeForces, LinearisedSpringsFollowToFirstOrder) {
  const auto error = [&](double step_m, double stiffening) {
    Material material = elastic_material(5000.0, 0.25, 1000.0);
    material.stiffening = stiffening;
    SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, material);
    displace_at_random(lattice, 2e-4, 5);
    take_forces(lattice, 0.0f);
    Random random(6);
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      const Vector3 step(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      lattice.set_displacement(n, lattice.displacement(n) + step_m * step);
    }
    const LatticeView view = lattice.view();
    Drift still;
    still.speeds.cap_m_per_s = 1.0f;
    lattice.kernels().drift(view, still);
    lattice.kernels().start_forces(view);
    lattice.kernels().spring_forces(view);
    const std::vector<float> linear(view.fx, view.fx + lattice.mesh().node_count());
    lattice.kernels().linearise_springs(view, 0.0f, Linearised::tangents);
    lattice.kernels().start_forces(view);
    double sum = 0.0, magnitude = 0.0;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      sum += std::abs(static_cast<double>(linear[static_cast<std::size_t>(n)]) - view.fx[n]);
      magnitude += std::abs(view.fx[n]);
    }
    return sum / magnitude;
  };
  for (const double stiffening : {0.0, 2.0, -20.0}) {
    const double large = error(4e-5, stiffening), small = error(2e-5, stiffening);
    EXPECT_LT(large, 0.02) << stiffening;
    EXPECT_NEAR(large / small, 4.0, 0.4) << stiffening;  // the bound allows for terms of third order
  }
}

// The springs of a fast lattice are linearised in each substep, without tangents. When it is slow again, the
// tangents are those that would have been stored.
TEST(LatticeForces, AreTheSameWheneverTangentsAreStored) {
  constexpr float h_s = 1e-4f, fast = 1.0f, slow = 0.02f;
  int substeps_without = 0;
  const auto run = [&](bool stores_at_once) {
    SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, elastic_material(5000.0, 0.45, 1000.0));
    displace_at_random(lattice, 2e-4, 5);
    const LatticeView view = lattice.view();
    lattice.kernels().linearise_springs(view, 0.0f, Linearised::tangents);
    LinearisedSprings springs;
    Random random(6);
    std::vector<float> forces;
    float moved_square = 0.0f;
    for (const float m_per_s : {fast, fast, fast, slow, slow, fast, slow, fast, fast, slow}) {
      if (stores_at_once) springs.age_substeps = 2;
      compute_forces(lattice, view, moved_square, {0.0, -9.81, 0.0}, springs);
      substeps_without += springs.stored == Linearised::forces ? 1 : 0;
      for (const float* force : {view.fx, view.fy, view.fz}) {
        forces.insert(forces.end(), force, force + view.padded_count);
      }
      for (int n = 0; n < lattice.mesh().node_count(); ++n) {
        for (float* velocity : {view.vx, view.vy, view.vz}) {
          velocity[n] = m_per_s * static_cast<float>(random.uniform(-1, 1));
        }
      }
      Drift drift;
      drift.h_s = h_s;
      drift.speeds.cap_m_per_s = 10.0f;
      moved_square = lattice.kernels().drift(view, drift).moved_square;
    }
    return forces;
  };
  const std::vector<float> at_once = run(true);
  EXPECT_EQ(substeps_without, 0);
  EXPECT_EQ(run(false), at_once);
  EXPECT_EQ(substeps_without, 4);
}

// In a lattice that grows evenly all springs have the same strain: the forces are those of linear springs
// times a factor that depends on the strain.
TEST(LatticeForces, SpringsStiffenAndSoftenWithTheirStrain) {
  const auto force_on_corner = [](double stiffening, double strain) {
    Material material = elastic_material(5000.0, 0.25, 1000.0);
    material.stiffening = stiffening;
    SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {3, 3, 3}, material);
    for (int n = 0; n < 27; ++n) lattice.set_displacement(n, strain * lattice.mesh().nodes[n]);
    take_forces(lattice, 0.0f);
    return static_cast<double>(lattice.view().fx[0]);
  };
  for (const double strain : {-0.2, -0.05, 0.01, 0.1, 0.3}) {
    const double linear = force_on_corner(0.0, strain);
    // The bound allows for single precision at strains of a hundredth.
    EXPECT_NEAR(force_on_corner(8.0, strain) / linear, 1.0 + 8.0 * strain * strain, 1e-4) << strain;
    EXPECT_NEAR(force_on_corner(-8.0, strain) / linear, 1.0 / std::sqrt(1.0 + 8.0 * strain * strain), 1e-4)
        << strain;
  }
  EXPECT_NEAR(force_on_corner(100.0, 0.3) / force_on_corner(0.0, 0.3), 2.0, 1e-4);
}

// Below Poisson's ratio 1/4, the volume forces have a negative stiffness: they dilate a dilated cell further
// and compress a compressed cell further. Beyond a change of volume of a tenth, they become weaker.
TEST(LatticeForces, NegativeVolumeForcesGiveWay) {
  const auto pressure = [](double poisson, double dilation) {
    const Material material = elastic_material(5000.0, poisson, 1000.0);
    SpringLattice lattice = block({5e-3, 5e-3, 5e-3}, {2, 2, 2}, material);
    const double stretch = std::cbrt(1.0 + dilation) - 1.0;
    for (int n = 0; n < 8; ++n) lattice.set_displacement(n, stretch * lattice.mesh().nodes[n]);
    take_forces(lattice, 0.0f);
    const LatticeView view = lattice.view();
    lattice.kernels().start_forces(view);
    const double springs = view.fx[0];
    lattice.kernels().volume_forces(view);
    return (view.fx[0] - springs) / bulk_stiffness(5000.0, poisson);
  };
  for (const double dilation : {-0.3, -0.02, 0.05, 0.4}) {
    EXPECT_NEAR(pressure(0.2, dilation) / pressure(0.3, dilation), 1.0 / (1.0 + 100.0 * dilation * dilation),
                1e-3)
        << dilation;
  }
}

TEST(LatticeForces, EveryInstructionSetGivesTheSameBits) {
  Material material = elastic_material(5000.0, 0.22, 1000.0);
  material.stiffening = 5.0;
  SpringLattice reference = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, material, InstructionSet::baseline);
  displace_at_random(reference, 2e-4, 3);
  for (int step = 0; step < 50; ++step) {
    plain_substep(reference, 1e-4f);
    reference.kernels().flow(reference.view(), {0.005f, 0.1f, 0.05f});
    reference.kernels().creep(reference.view(), step % lattice_direction_count, {0.5f, 0.05f});
  }
  for (const InstructionSet set : available_instruction_sets()) {
    SpringLattice lattice = block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, material, set);
    EXPECT_EQ(lattice.fastest_frequency(),
              block({5e-3, 4e-3, 6e-3}, {6, 5, 7}, material).fastest_frequency());
    displace_at_random(lattice, 2e-4, 3);
    for (int step = 0; step < 50; ++step) {
      plain_substep(lattice, 1e-4f);
      lattice.kernels().flow(lattice.view(), {0.005f, 0.1f, 0.05f});
      lattice.kernels().creep(lattice.view(), step % lattice_direction_count, {0.5f, 0.05f});
    }
    EXPECT_EQ(lattice.shape(), reference.shape()) << name_of(set);
  }
}

// The squares of the accelerations of the stiffest, lightest and smallest lattice exceed single precision.
TEST(LatticeForces, TheFastestLatticeHasAFrequency) {
  for (const InstructionSet set : available_instruction_sets()) {
    const auto frequency = [&](double size_m, double youngs_modulus_pa, double density_kg_per_m3) {
      const Material material = elastic_material(youngs_modulus_pa, 0.3, density_kg_per_m3);
      return block(Vector3::Constant(size_m), {5, 5, 5}, material, set).fastest_frequency();
    };
    const double usual = frequency(4e-3, 1e6, 1e3), fastest = frequency(1e-4, 1e12, 1.0);
    EXPECT_NEAR(fastest / usual / (40.0 * std::sqrt(1e9)), 1.0, 1e-3) << name_of(set);
  }
}

}  // namespace
}  // namespace spoonbill
