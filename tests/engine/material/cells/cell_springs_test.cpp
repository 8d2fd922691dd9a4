#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine/material/cells/spring_cell.h"

namespace spoonbill {
namespace {

CellCorners brick(double a, double b, double c) {
  return box_mesh({a, b, c}, {2, 2, 2}).cell(0, 0, 0);
}

// A uniaxial patch test measures E and nu of the homogenised cell along every axis.
TEST(CellSprings, CubesGiveTheMaterialExactly) {
  for (const double nu : {0.25, 0.35, 0.45, 0.49}) {
    const CellCorners corners = brick(2e-3, 2e-3, 2e-3);
    const CellSprings springs = cell_springs(corners, shear_modulus(5000.0, nu));
    const AchievedElasticity achieved = achieved_elasticity(corners, springs, bulk_stiffness(5000.0, nu));
    for (int axis = 0; axis < 3; ++axis) {
      // The tolerance of 1e-6 is the test's own choice; the solve is in double precision.
      EXPECT_NEAR(achieved.youngs_modulus_pa[axis] / 5000.0, 1.0, 1e-6) << "nu " << nu;
      EXPECT_NEAR(achieved.poissons_ratio[axis], nu, 1e-6);
    }
  }
}

TEST(CellSprings, BricksGiveTheMaterialExactly) {
  for (const CellCorners& corners :
       {brick(1.2e-3, 1e-3, 1e-3), brick(1e-3, 1.2e-3, 1.1e-3), brick(1.5e-3, 1.5e-3, 1e-3)}) {
    const CellSprings springs = cell_springs(corners, shear_modulus(1e5, 0.45));
    const AchievedElasticity achieved = achieved_elasticity(corners, springs, bulk_stiffness(1e5, 0.45));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(achieved.youngs_modulus_pa[axis] / 1e5, 1.0, 1e-6);
      EXPECT_NEAR(achieved.poissons_ratio[axis], 0.45, 1e-6);
    }
  }
}

// A cubic lattice of spacing a, with springs k1 along edges, k2 along face diagonals and k3 along body
// diagonals, has C11 = (k1 + 2 k2 + 4 k3 / 3) / a and C12 = C44 = (k2 + 4 k3 / 3) / a. It is isotropic if
// k1 = k2 + 8 k3 / 3. A cell has a quarter of each k1, half of each k2 and all of each k3.
TEST(CellSprings, CubeStiffnessesMeetTheClosedForm) {
  const double a = 2e-3, mu = 700.0;
  const CellSprings springs = cell_springs(brick(a, a, a), mu);
  const double k1 = 4.0 * springs.stiffness_n_per_m[0], k2 = 2.0 * springs.stiffness_n_per_m[12],
               k3 = springs.stiffness_n_per_m[24];
  EXPECT_NEAR((k2 + 4.0 * k3 / 3.0) / a, mu, 1e-9 * mu);
  EXPECT_NEAR((k1 + 2.0 * k2 + 4.0 * k3 / 3.0) / a, 3.0 * mu, 1e-9 * mu);
  EXPECT_NEAR(k1, k2 + 8.0 * k3 / 3.0, 1e-9 * k1);
}

TEST(CellSprings, SlenderCellsKeepPositiveSpringsAndReportTheirMisfit) {
  const CellSprings slender = cell_springs(brick(4e-3, 1e-3, 1e-3), 700.0);
  for (const double k : slender.stiffness_n_per_m) EXPECT_GT(k, 0.0);
  EXPECT_GT(slender.misfit, 0.05);
  EXPECT_LT(cell_springs(brick(1e-3, 1e-3, 1e-3), 700.0).misfit, 1e-9);
}

// Returns a cell from the corner of a square grid that was bent into a circle. Its outer corner has an angle
// of 127 degrees.
CellCorners corner_of_round_section() {
  CellCorners corners = brick(1e-3, 1e-3, 1.5e-3);
  for (const int c : {6, 7}) {
    corners[static_cast<std::size_t>(c)].x() -= 0.25e-3;
    corners[static_cast<std::size_t>(c)].y() -= 0.25e-3;
  }
  return corners;
}

TEST(CellSprings, OfADistortedCellHaveTheMaterialsModulusAlongIt) {
  const CellCorners corners = corner_of_round_section();
  for (const double nu : {0.29, 0.37, 0.48, 0.49}) {
    const double bulk = bulk_stiffness(1e5, nu);
    const CellSprings fitted = cell_springs(corners, shear_modulus(1e5, nu));
    EXPECT_GT(fitted.misfit, 0.01);
    EXPECT_GT(std::abs(modulus_along(Vector3::UnitZ(), corners, fitted, bulk) / 1e5 - 1.0), 1e-3) << nu;
    const CellSprings scaled = material_springs(corners, 1e5, nu);
    EXPECT_NEAR(modulus_along(Vector3::UnitZ(), corners, scaled, bulk) / 1e5, 1.0, 1e-3) << nu;
  }
}

TEST(CellSprings, OfTooSlenderACellAreNotScaled) {
  const CellCorners corners = brick(1e-3, 1e-3, 2e-3);
  EXPECT_EQ(material_springs(corners, 1e5, 0.4).stiffness_n_per_m,
            cell_springs(corners, shear_modulus(1e5, 0.4)).stiffness_n_per_m);
}

TEST(CellSprings, TheModulusAlongAnAxisIsTheAchievedOne) {
  const CellCorners corners = brick(1e-3, 1.4e-3, 1e-3);
  const CellSprings springs = cell_springs(corners, 700.0);
  const AchievedElasticity achieved = achieved_elasticity(corners, springs, 500.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double modulus_pa = modulus_along(Vector3::Unit(axis), corners, springs, 500.0);
    EXPECT_NEAR(modulus_pa / achieved.youngs_modulus_pa[axis], 1.0, 1e-9);
  }
}

// The stiffness matrix of the springs of one cell has the six rigid motions as its only zero modes.
TEST(CellSprings, OnlyRigidMotionsCostNoEnergy) {
  for (const CellCorners& corners :
       {brick(1e-3, 1e-3, 1e-3), brick(1.7e-3, 1e-3, 1e-3), brick(1.5e-3, 1.5e-3, 1e-3)}) {
    const CellSprings springs = cell_springs(corners, 700.0);
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(24, 24);
    for (int s = 0; s < cell_spring_count; ++s) {
      const auto [a, b] = cell_spring_corners[s];
      const Vector3 n = (corners[b] - corners[a]).normalized();
      Eigen::VectorXd row = Eigen::VectorXd::Zero(24);
      row.segment<3>(3 * a) = -n;
      row.segment<3>(3 * b) = n;
      stiffness += springs.stiffness_n_per_m[s] * row * row.transpose();
    }
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
    EXPECT_LT(values[5], 1e-9 * values[23]);
    EXPECT_GT(values[6], 1e-3 * values[23]);
  }
}

}  // namespace
}  // namespace spoonbill
