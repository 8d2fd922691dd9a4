// Tests that the coarse block of cells of the implicit solver weighs as much as the lattice.
#include "engine/material/implicit/implicit_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/material/block.h"
#include "tests/engine/material/lattice/filled_volume.h"

namespace spoonbill {
namespace {

// Returns a box that is empty except for a floor and two walls, each one cell thick.
LatticeMesh bowl_in_box(const std::array<int, 3>& counts) {
  LatticeMesh box = box_mesh({0.04, 0.04, 0.04}, counts);
  box.filled.assign(box.cell_count(), true);
  box.cell_fractions.assign(box.cell_count(), 1e-3);
  for (int k = 0; k + 1 < counts[2]; ++k) {
    for (int i = 0; i + 1 < counts[0]; ++i) {
      for (int j = 0; j + 1 < counts[1]; ++j) {
        const bool floor = j == counts[1] / 2, wall = j > counts[1] / 2 && (i == 1 || k == counts[2] - 3);
        if (floor || wall) box.cell_fractions[box.cell_index(i, j, k)] = floor ? 0.9 : 0.4 + 0.01 * i;
      }
    }
  }
  return box;
}

// Returns the mean filled fraction of a coarse cell. It is computed over a common subdivision of both grids,
// so that each part is inside one cell of either grid.
double mean_share(const LatticeMesh& fine, const LatticeMesh& coarse, const std::array<int, 3>& cell) {
  const auto finer = [&](std::size_t axis, int part) {
    const int whole = cell[axis] * (fine.count[axis] - 1) + part;
    return whole / (coarse.count[axis] - 1);
  };
  double sum = 0.0;
  for (int a = 0; a + 1 < fine.count[0]; ++a) {
    for (int b = 0; b + 1 < fine.count[1]; ++b) {
      for (int c = 0; c + 1 < fine.count[2]; ++c)
        sum += fine.cell_fraction(finer(0, a), finer(1, b), finer(2, c));
    }
  }
  return sum / static_cast<double>(fine.cell_count());
}

// The node counts along the three axes are equal, except in one box.
TEST(ImplicitSolver, HasOfEachCellWhatTheLatticeHasThere) {
  const Material stiff = elastic_material(2e9, 0.3, 1000.0);
  for (const auto& counts : {std::array<int, 3>{12, 12, 12}, {20, 20, 20}, {34, 34, 34}, {7, 13, 24}}) {
    const LatticeMesh fine = bowl_in_box(counts);
    const ImplicitSolver core =
        ImplicitSolver::make(fine, fine.nodes, stiff, InstructionSet::baseline).value();
    const LatticeMesh& coarse = core.mesh();
    ASSERT_LT(coarse.cell_count(), fine.cell_count());
    // The bound allows for the rounding of some thousands of sums.
    EXPECT_NEAR(filled_m3(coarse) / filled_m3(fine), 1.0, 1e-12) << counts[0];
    for (int k = 0; k + 1 < coarse.count[2]; ++k) {
      for (int i = 0; i + 1 < coarse.count[0]; ++i) {
        for (int j = 0; j + 1 < coarse.count[1]; ++j) {
          EXPECT_NEAR(coarse.cell_fraction(i, j, k), mean_share(fine, coarse, {i, j, k}), 1e-12)
              << counts[0] << ": " << i << ", " << j << ", " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
