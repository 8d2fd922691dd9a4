// Tests single hexahedral cells.
#include "engine/material/cells/hexahedron.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "engine/material/cells/corotated_cell.h"
#include "engine/material/cells/spring_cell.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

Vector3 random_vector(Random& random, double size) {
  return size * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
}

// Returns a cell whose edges all differ in length and direction.
CellCorners distorted_cell(std::uint64_t seed) {
  Random random(seed);
  CellCorners corners = box_mesh({1.2, 1.0, 0.8}, {2, 2, 2}).cell(0, 0, 0);
  for (Vector3& corner : corners) corner += random_vector(random, 0.12);
  return corners;
}

// Returns the displacements of the corners under a uniform displacement gradient.
CellVector moved_by(const Eigen::Matrix3d& gradient, const CellCorners& corners) {
  CellVector moves;
  for (int c = 0; c < 8; ++c) moves.segment<3>(3 * c) = gradient * corners[static_cast<std::size_t>(c)];
  return moves;
}

TEST(Hexahedron, OnlyRigidMotionsCostNoEnergy) {
  for (const double poisson : {-0.5, 0.0, 0.25, 0.45, 0.49, 0.4999}) {
    const CellMatrix stiffness = hexahedron_stiffness(distorted_cell(3), 1.0, poisson);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness);
    // The bound allows for rounding of a matrix with entries of about 1 / (1 - 2 nu).
    EXPECT_LT(std::abs(modes.eigenvalues()[5]), 1e-14 / (1.0 - 2.0 * poisson)) << poisson;
    EXPECT_GT(modes.eigenvalues()[6], 1e-2) << poisson;
  }
}

// A cell of any shape under a uniform strain e stores the energy of the material, V/2 s:e, where V is its
// volume and s the stress.
TEST(Hexahedron, UniformStrainsCostWhatTheMaterialAsks) {
  Random random(17);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double youngs = 3.0, poisson = random.uniform(-0.3, 0.49);
    const CellCorners corners = distorted_cell(seed);
    Eigen::Matrix3d gradient;
    for (int column = 0; column < 3; ++column) gradient.col(column) = random_vector(random, 1.0);
    const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
    const double shear = youngs / (2.0 * (1.0 + poisson));
    const double lambda = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
    const double energy = cell_volume(corners) *
                          (shear * strain.squaredNorm() + 0.5 * lambda * strain.trace() * strain.trace());
    const CellVector moves = moved_by(gradient, corners);
    const CellVector force = hexahedron_stiffness(corners, youngs, poisson) * moves;
    EXPECT_NEAR(0.5 * moves.dot(force), energy, 1e-12 * energy) << seed;
  }
}

// End moments bend a cell of length L to the curvature k with the energy E I / 2 k^2 L. Without internal
// displacement modes, a trilinear cell of height h would overestimate the energy by the factor
// (L/h)^2 / (2 (1 + nu)): more than a hundred here.
TEST(Hexahedron, BendsAsABeam) {
  const double length = 20.0, wide = 1.0, high = 1.0, curvature = 1e-3;
  const CellCorners corners = box_mesh({length, wide, high}, {2, 2, 2}).cell(0, 0, 0);
  CellVector moves = CellVector::Zero();
  for (int c = 0; c < 8; ++c) {
    const Vector3 at = corners[static_cast<std::size_t>(c)] - 0.5 * Vector3(length, wide, high);
    moves[3 * c] = -curvature * at.x() * at.z();
  }
  // With Poisson's ratio 0 the cross section does not deform.
  const CellMatrix stiffness = hexahedron_stiffness(corners, 7.0, 0.0);
  const double energy = 0.5 * 7.0 * wide * std::pow(high, 3) / 12.0 * curvature * curvature * length;
  EXPECT_NEAR(0.5 * moves.dot(stiffness * moves), energy, 1e-9 * energy);
}

// Returns the displacements of a cell that is turned by 1.1 rad and strained by some percent.
CellMoves turned_and_strained(const CellCorners& corners, std::uint64_t seed) {
  Random random(seed);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  CellMoves moves;
  for (std::size_t c = 0; c < 8; ++c) {
    moves[c] = turn * (corners[c] + random_vector(random, 0.03)) + Vector3(5.0, -7.0, 2.0) - corners[c];
  }
  return moves;
}

// Compares the force and the tangent with central differences of the energy and of the force.
// `tangent_tolerance` is relative to the norm of the tangent.
template <class Cell>
void expect_derivatives(const Cell& cell, const CellMoves& moves, double tangent_tolerance) {
  const CellResponse response = cell.respond(moves, Tangent::stressed);
  constexpr double step = 1e-5;
  for (int a = 0; a < 24; ++a) {
    CellMoves up = moves, down = moves;
    up[static_cast<std::size_t>(a / 3)][a % 3] += step;
    down[static_cast<std::size_t>(a / 3)][a % 3] -= step;
    // The bound allows for the third derivatives with a step of 1e-5 and for rounding divided by that step.
    EXPECT_NEAR((cell.energy_j(up) - cell.energy_j(down)) / (2.0 * step), response.force_n[a],
                1e-8 * response.force_n.norm() + 1e-10);
    const CellVector change =
        (cell.respond(up, Tangent::plain).force_n - cell.respond(down, Tangent::plain).force_n) /
        (2.0 * step);
    EXPECT_LT((change - response.tangent.col(a)).norm(), tangent_tolerance * response.tangent.norm());
  }
  EXPECT_LT((response.tangent - response.tangent.transpose()).norm(), 1e-12 * response.tangent.norm());
}

TEST(CorotatedCell, ForceIsTheGradientOfItsEnergyAndTheTangentItsChange) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CellCorners corners = distorted_cell(seed);
    const CorotatedCell cell(corners, hexahedron_stiffness(corners, 1.0, 0.3));
    // The tangent neglects how the strain changes the rotation. This term is a product of two small strains.
    expect_derivatives(cell, turned_and_strained(corners, seed), 1e-3);
  }
}

TEST(SpringCell, ForceIsTheGradientOfItsEnergyAndTheTangentItsChange) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CellCorners corners = distorted_cell(seed);
    const SpringCell cell(corners, cell_springs(corners, 0.4), 2.0, 1.0);
    expect_derivatives(cell, turned_and_strained(corners, seed), 1e-8);
  }
}

// A cell that is turned without strain exerts no force, at any angle. The forces of a strained cell never
// have a moment.
TEST(CorotatedCell, FeelsNoTurn) {
  const CellCorners corners = distorted_cell(9);
  const CorotatedCell cell(corners, hexahedron_stiffness(corners, 1.0, 0.3));
  for (const double angle : {1e-9, 1e-4, 0.5, 1.6, 3.1}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vector3(2.0, -1.0, 1.0).normalized()).matrix();
    CellMoves moves;
    for (std::size_t c = 0; c < 8; ++c) moves[c] = turn * corners[c] - corners[c];
    // The bound allows for rounding of the displacements, which are as large as the rotation.
    EXPECT_LT(cell.respond(moves, Tangent::plain).force_n.norm(), 1e-15 * std::max(1.0, angle)) << angle;
    const CellMoves strained = turned_and_strained(corners, 4);
    const CellVector force = cell.respond(strained, Tangent::plain).force_n;
    Vector3 sum = Vector3::Zero(), moment = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) {
      const Vector3 of_corner = force.segment<3>(3 * static_cast<Eigen::Index>(c));
      sum += of_corner;
      moment += (corners[c] + strained[c]).cross(of_corner);
    }
    EXPECT_LT(sum.norm(), 1e-13);
    EXPECT_LT(moment.norm(), 1e-13);
  }
}

// A turn by a millionth of a radian, as in a steel cell, is found without loss of digits.
TEST(CorotatedCell, KeepsTheDigitsOfSmallTurns) {
  const Vector3 axis(3e-7, -5e-7, 8e-7);
  Eigen::Matrix3d change;
  change << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  const Eigen::Matrix3d turn = nearest_turn(change);
  // sin(a) differs from a by a^3 / 6, which is less than 1e-12 of a.
  EXPECT_LT((0.5 * (turn - turn.transpose()) - change).norm(), 1e-12 * change.norm());
}

}  // namespace
}  // namespace spoonbill
