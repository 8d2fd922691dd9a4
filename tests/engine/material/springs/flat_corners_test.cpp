// Tests how flat and inverted corners of lattice cells resist.
#include "engine/material/springs/flat_corners.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/material/cells/hexahedron.h"
#include "engine/material/lattice_solver.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

constexpr double shear_pa = 2000.0, poissons_ratio = 0.45;

SpringLattice gel(std::array<int, 3> counts, InstructionSet set = InstructionSet::baseline) {
  const Vector3 size_m(1e-3 * (counts[0] - 1), 1.2e-3 * (counts[1] - 1), 0.9e-3 * (counts[2] - 1));
  return block(size_m, counts,
               elastic_material(2.0 * (1.0 + poissons_ratio) * shear_pa, poissons_ratio, 1000.0), set);
}

void shake_nodes(SpringLattice& lattice, double amplitude_m, std::uint64_t seed) {
  Random random(seed);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    lattice.set_displacement(
        n, amplitude_m * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
  }
}

// Returns the ratios of the eight corners of a cell.
std::array<double, 8> corner_ratios(const SpringLattice& lattice, int i, int j, int k) {
  LatticeMesh present = lattice.mesh();
  present.nodes = lattice.positions();
  const CellCorners before = lattice.mesh().cell(i, j, k), after = present.cell(i, j, k);
  std::array<double, 8> ratios{};
  for (int c = 0; c < 8; ++c) {
    const Vector3 at(c >> 2 & 1, c >> 1 & 1, c & 1);
    ratios[static_cast<std::size_t>(c)] = trilinear_jacobian(after, at.x(), at.y(), at.z()).determinant() /
                                          trilinear_jacobian(before, at.x(), at.y(), at.z()).determinant();
  }
  return ratios;
}

double smallest_ratio(const SpringLattice& lattice) {
  double smallest = 1e9;
  const std::array<int, 3>& count = lattice.mesh().count;
  for (int i = 0; i + 1 < count[0]; ++i) {
    for (int j = 0; j + 1 < count[1]; ++j) {
      for (int k = 0; k + 1 < count[2]; ++k) {
        for (const double ratio : corner_ratios(lattice, i, j, k)) smallest = std::min(smallest, ratio);
      }
    }
  }
  return smallest;
}

TEST(FlatCorners, AreFoundOnEveryInstructionSet) {
  constexpr float limit = 0.4f;
  for (const InstructionSet set : available_instruction_sets()) {
    SpringLattice lattice = gel({7, 6, 8}, set);
    shake_nodes(lattice, 3e-4, 5);
    std::vector<unsigned char> flat(static_cast<std::size_t>(lattice.view().padded_count), 2);
    EXPECT_TRUE(lattice.kernels().find_flat_cells(lattice.view(), limit, least_corner_volume, flat.data()));
    int found = 0, cells = 0;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      const auto [i, j, k] = lattice.mesh().grid_index(n);
      bool expected = false;
      if (i + 1 < 7 && j + 1 < 6 && k + 1 < 8) {
        const std::array<double, 8> ratios = corner_ratios(lattice, i, j, k);
        expected = *std::min_element(ratios.begin(), ratios.end()) < static_cast<double>(limit);
        ++cells;
      }
      EXPECT_EQ(flat[static_cast<std::size_t>(n)], expected ? 1 : 0) << n;
      found += expected ? 1 : 0;
    }
    EXPECT_GT(found, cells / 10);
    EXPECT_LT(found, cells * 9 / 10);
    lattice = gel({7, 6, 8}, set);
    EXPECT_FALSE(lattice.kernels().find_flat_cells(lattice.view(), limit, least_corner_volume, flat.data()));
  }
}

// The energy of the corners of a single cell, 1/2 K (0.3 - j)^2 each with K = 15 G V / 8.
double corner_energy_j(const SpringLattice& lattice) {
  double sum = 0.0;
  for (const double ratio : corner_ratios(lattice, 0, 0, 0)) {
    const double beyond = std::max(0.0, static_cast<double>(flat_corner_ratio) - ratio);
    sum += 0.5 * 15.0 / 8.0 * shear_pa * lattice.rest_volume_m3() * beyond * beyond;
  }
  return sum;
}

// In an endless number of substeps, the forces are the gradient of the energy.
TEST(FlatCorners, PushWithTheGradientOfTheirEnergy) {
  SpringLattice lattice = gel({2, 2, 2});
  shake_nodes(lattice, 5e-4, 3);
  ASSERT_LT(smallest_ratio(lattice), 0.1);
  const LatticeView view = lattice.view();
  lattice.kernels().start_forces(view);  // sets forces to 0, because the springs were linearised at rest
  lattice.find_flat_corners();
  lattice.resist_inversion(view, 1e-9f);
  const float* force[3] = {view.fx, view.fy, view.fz};
  double largest = 0.0;
  for (int n = 0; n < 8; ++n) largest = std::max(largest, static_cast<double>(std::abs(view.fx[n])));
  ASSERT_GT(largest, 0.0);
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < 8; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 at = lattice.displacement(n);
      Vector3 step = Vector3::Zero();
      step[axis] = 1e-7;
      SpringLattice moved = lattice;
      moved.set_displacement(n, at + step);
      const double up = corner_energy_j(moved);
      moved.set_displacement(n, at - step);
      const double gradient = (up - corner_energy_j(moved)) / 2e-7;
      // The bound allows for single precision of the displaced nodes divided by the difference step.
      EXPECT_NEAR(force[axis][n], -gradient, 2e-3 * largest);
      sum[axis] += static_cast<double>(force[axis][n]);
    }
  }
  EXPECT_LT(sum.norm(), 1e-5 * largest);
}

// Returns how fast a corner that was pushed through its cell returns after a tick.
double return_m_per_s(bool is_real_time) {
  SpringLattice lattice = gel({4, 4, 4});
  const Vector3 diagonal = lattice.mesh().nodes[static_cast<std::size_t>(lattice.mesh().index(1, 1, 1))];
  lattice.set_displacement(0, 0.8 * diagonal);
  EXPECT_LT(smallest_ratio(lattice), 0.0);
  RelaxSettings settings;
  settings.substeps = 20;
  settings.is_real_time = is_real_time;
  settings.time_s = 1e-4;
  relax(std::array{RelaxedLattice{&lattice}}, settings, {});
  return -lattice.velocity(0).dot(diagonal.normalized());
}

// Sculpting keeps its forces. RandomScenes.StayWholeWhenCellsAreTurnedInsideOut shows the effect.
TEST(FlatCorners, ActInRealTimeOnly) {
  EXPECT_GT(return_m_per_s(true), 1.2 * return_m_per_s(false));
}

}  // namespace
}  // namespace spoonbill
