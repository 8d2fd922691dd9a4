// Tests the inertia scale of lattices: the largest stable substep, forces at rest and the time of a motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/processor.h"
#include "engine/material/lattice_solver.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

constexpr double inertia_step_s = 1e-3;

Material damped_material(double poissons_ratio, double damping_time_s) {
  Material material = elastic_material(1e6, poissons_ratio, 1000.0);
  material.damping_time_s = damping_time_s;
  return material;
}

SpringLattice stiff_block(const Material& material) {
  return block({0.009, 0.009, 0.015}, {4, 4, 6}, material);
}

void scale_inertia(SpringLattice& lattice) {
  lattice.set_inertia(lattice.find_inertia_scale(inertia_step_s), inertia_step_s);
}

// With the inertia scale, a substep is stable with the safety margin rest_stability_fraction, for any damping
// of the springs and any stiffness of the cells against changes of volume.
TEST(Inertia, IsTheLeastWithWhichASubstepIsStable) {
  for (const double poissons_ratio : {0.25, 0.45}) {
    for (const double damping_time_s : {0.0, 1e-4, damping_time_range_s.high}) {
      SpringLattice lattice = stiff_block(damped_material(poissons_ratio, damping_time_s));
      EXPECT_EQ(lattice.inertia_scale(), 1.0);
      scale_inertia(lattice);
      EXPECT_GT(lattice.inertia_scale(), 10.0);
      // At the step for which the inertia was scaled, the two bounds of stable_step_s(), for cells and for
      // springs, agree. The tolerance covers single precision: the bound for springs is a small difference of
      // two long times.
      EXPECT_NEAR(lattice.stable_step_s(rest_stability_fraction) / inertia_step_s, 1.0, 1e-3)
          << poissons_ratio << ", " << damping_time_s;
    }
  }
}

TEST(Inertia, OfASoftBodyIsItsMass) {
  SpringLattice lattice = stiff_block(elastic_material(100.0, 0.3, 1000.0));
  EXPECT_EQ(lattice.find_inertia_scale(inertia_step_s), 1.0);
  EXPECT_EQ(lattice.find_real_time_step_s(inertia_step_s), inertia_step_s);
}

// Smoothing moves nodes together with their rest shape. The scale remains that of the shape in which the
// lattice was made, although the cells at one end become 1.8 times as large.
TEST(Inertia, IsThatOfTheFirstRestShape) {
  SpringLattice fresh = stiff_block(damped_material(0.45, 1e-4)), smoothed = fresh;
  for (int n = 0; n < smoothed.mesh().node_count(); ++n) {
    if (smoothed.mesh().grid_index(n)[0] > 0) continue;
    ASSERT_TRUE(smoothed.reform(n, {-0.0024, 0.0, 0.0}));
  }
  EXPECT_EQ(smoothed.find_inertia_scale(inertia_step_s), fresh.find_inertia_scale(inertia_step_s));
}

// In real time, the step is inertia_step_s divided by an integer. If inertia_step_s were divided by the next
// smaller integer, the step would require a larger inertia.
TEST(Inertia, OfRealTimeNeedsAShorterStep) {
  for (const double damping_time_s : {0.0, 1e-4}) {
    SpringLattice lattice = stiff_block(damped_material(0.4, damping_time_s));
    const double step_s = lattice.find_real_time_step_s(inertia_step_s);
    const double count = inertia_step_s / step_s;
    EXPECT_GT(count, 1.5);
    EXPECT_NEAR(count, std::round(count), 1e-9);
    EXPECT_EQ(lattice.find_inertia_scale(step_s), 1.0) << damping_time_s;
    EXPECT_GT(lattice.find_inertia_scale(inertia_step_s / (std::round(count) - 1.0)), 1.0) << damping_time_s;
  }
}

// A block thrown about with the scaled inertia stays bounded for two thousand single substeps.
TEST(Inertia, KeepsAShakenBlockStable) {
  const DenormalsFlushed flushed;
  for (const double damping_time_s : {0.0, 1e-4, damping_time_range_s.high}) {
    SpringLattice lattice = stiff_block(damped_material(0.45, damping_time_s));
    scale_inertia(lattice);
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      lattice.set_velocity(n, 1e-4 * Vector3(std::sin(7.0 * n), std::sin(11.0 * n), std::sin(13.0 * n)));
    }
    const double before = momentum_of(lattice).energy_j;
    RelaxSettings settings;
    for (; settings.tick < 2000; ++settings.tick) {
      EXPECT_EQ(relax(std::array{RelaxedLattice{&lattice}}, settings, {}).substeps, 1) << settings.tick;
    }
    // Near the stability limit the energy of symplectic Euler oscillates without growing.
    EXPECT_LT(momentum_of(lattice).energy_j, 10.0 * before) << damping_time_s;
  }
}

// Nothing but the inertia is scaled: with the inertia scale r, a block falls at g / r.
TEST(Inertia, SlowsAFallByTheScale) {
  SpringLattice lattice = stiff_block(damped_material(0.3, 0.0));
  scale_inertia(lattice);
  constexpr double g_m_per_s2 = 9.81;
  constexpr int ticks = 500;
  RelaxSettings settings;
  for (; settings.tick < ticks; ++settings.tick) {
    relax(std::array{RelaxedLattice{&lattice, Vector3(0.0, -g_m_per_s2, 0.0)}}, settings, {});
  }
  const double expected = 0.5 * g_m_per_s2 / lattice.inertia_scale() * 1e-6 * ticks * (ticks + 1);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    EXPECT_NEAR(lattice.displacement(n).y() / -expected, 1.0, 1e-4);
  }
}

// Returns the displacement of the pulled end of a block after each tick; the other end is fixed. The inertia
// is scaled for the number of substeps.
std::vector<double> pull_end(int substeps, int ticks, double drag_per_s) {
  SpringLattice lattice = stiff_block(damped_material(0.3, 0.0));
  const LatticeMesh& mesh = lattice.mesh();
  std::vector<std::uint8_t> fixed(static_cast<std::size_t>(mesh.node_count()), 0);
  const int slice = mesh.count[0] * mesh.count[1], last = mesh.node_count() - 1;
  std::fill_n(fixed.begin(), slice, std::uint8_t{1});
  lattice.fix_nodes(fixed);
  const double step_s = inertia_step_s / substeps;
  lattice.set_inertia(lattice.find_inertia_scale(step_s), step_s);
  for (int n = last - slice + 1; n <= last; ++n) lattice.set_node_force(n, {0.0, 0.0, 1e-3});
  RelaxSettings settings;
  settings.substeps = substeps;
  settings.drag_per_s = drag_per_s;
  std::vector<double> displacement_m;
  for (; settings.tick < static_cast<std::uint64_t>(ticks); ++settings.tick) {
    relax(std::array{RelaxedLattice{&lattice}}, settings, {});
    displacement_m.push_back(lattice.displacement(last).z());
  }
  return displacement_m;
}

// The forces at rest are the true ones, so that the rest shape is the same at every inertia.
TEST(Inertia, DoesNotChangeTheRestShape) {
  const double at_one = pull_end(1, 1500, 100.0).back(), at_eight = pull_end(8, 1500, 100.0).back();
  EXPECT_GT(at_one, 1e-7);
  // The tolerance covers the remaining motion and single precision.
  EXPECT_NEAR(at_eight / at_one, 1.0, 2e-3);
}

// Half the substep needs a quarter of the inertia, so that the block swings twice as fast.
TEST(Inertia, DeterminesTheTimeOfASwing) {
  // Returns the number of ticks until the bar's tip is farthest from its start. The search stops when the tip
  // has swung back by half.
  const auto count_ticks_to_peak = [](int substeps) {
    const std::vector<double> swing = pull_end(substeps, 200, 0.0);
    std::size_t peak = 0;
    for (std::size_t tick = 1; tick < swing.size() && swing[tick] > 0.5 * swing[peak]; ++tick) {
      if (swing[tick] > swing[peak]) peak = tick;
    }
    return static_cast<double>(peak + 1);
  };
  EXPECT_NEAR(count_ticks_to_peak(1) / count_ticks_to_peak(2), 2.0, 0.3);
}

}  // namespace
}  // namespace spoonbill
