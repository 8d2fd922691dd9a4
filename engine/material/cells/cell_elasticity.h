// Deformation, response and elasticity of lattice cells, common to springs and hexahedra.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "engine/base/geometry.h"

namespace spoonbill {

// Vector of a cell's values, and matrix between such vectors. The values are ordered by corner, then axis: x,
// y, z of corner 0, of corner 1 and so on. The corners are in the order of LatticeMesh::cell().
using CellVector = Eigen::Matrix<double, 24, 1>;
using CellMatrix = Eigen::Matrix<double, 24, 24>;

// Displacements of a cell's corners from the rest shape, m. Positions would lose digits on which the forces
// of stiff cells depend.
using CellMoves = std::array<Vector3, 8>;

// Energy, forces and tangent of a deformed cell.
struct CellResponse {
  double energy_j = 0.0;
  CellVector force_n;  // gradient of the energy: external forces that hold the cell in its deformed shape
  CellMatrix tangent;  // derivative of the forces, N/m
};

// Selects whether a tangent includes the contribution of the present stress. Newton's method converges
// fastest with `stressed`. With `plain`, stress cannot make the tangent indefinite.
enum class Tangent : std::uint8_t { stressed, plain };

// Elasticity that a cell achieves along x, y and z. Plain data.
struct AchievedElasticity {
  Vector3 youngs_modulus_pa;
  Vector3 poissons_ratio;  // mean of the two lateral ratios in tension along each axis
};

// Computes the elasticity from the matrix that maps normal strains to normal stresses, Pa.
AchievedElasticity compute_elasticity(const Eigen::Matrix3d& normal_stiffness_pa);

// Elasticity that a body's cells achieve, compared with the requested one. The ratios are means over the
// cells, weighted by volume. Plain data.
struct LatticeReport {
  double youngs_modulus_ratio[3] = {};  // achieved modulus divided by the requested one, along x, y, z
  double poissons_ratio[3] = {};
  double wanted_poissons_ratio = 0.0;
  double worst_cell_misfit = 0.0;  // see CellSprings::misfit
  double worst_jacobian = 1.0;     // see smallest_jacobian_ratio()

  // Adds one cell to the sums.
  void add(double volume_m3, const AchievedElasticity& achieved, double wanted_modulus_pa,
           double wanted_ratio);
  // Turns the sums into means. Call once, after the last add().
  void divide_by(double volume_m3);
};

}  // namespace spoonbill
