// The stiffness of one lattice cell as an eight-node hexahedron that can bend: what a cell is made of where
// springs cannot do it (Poisson's ratios below 1/4, slender cells) or would take too many cells (beams).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "engine/material/cells/achieved_elasticity.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// By corner, then axis: x, y, z of corner 0, of corner 1, ... Corners as LatticeMesh::cell() counts them.
using CellVector = Eigen::Matrix<double, 24, 1>;
using CellMatrix = Eigen::Matrix<double, 24, 24>;

// Small displacements, m, to forces, N, both in the rest shape's axes: symmetric, with the six rigid motions
// as its only null space. Trilinear, with three quadratic displacements in each axis that are the cell's own
// and condensed out: bent, a trilinear cell shears instead and is too stiff, by half at one cell through a
// beam of L/H = 10, and it locks near nu = 1/2 (Wilson et al. 1973). Their gradients are taken with the
// Jacobian of the cell's centre, so that distorted cells pass the patch test (Taylor, Beresford and Wilson
// 1976). Two Gauss points an axis. The cell must not be folded over; -1 < nu < 1/2.
CellMatrix hexahedron_stiffness(const CellCorners& corners, double youngs_modulus_pa, double poissons_ratio);

// A part of a cell of one elasticity: a box in the cell's natural coordinates, each -1 to 1 along i, j, k.
struct HexahedronPart {
  Vector3 low = -Vector3::Ones(), high = Vector3::Ones();
  double youngs_modulus_pa = 0.0, poissons_ratio = 0.0;
};

// The same of a cell whose parts fill it: each is summed over Gauss points of its own, so that layers bend as
// a composite does.
CellMatrix hexahedron_stiffness(const CellCorners& corners, std::span<const HexahedronPart> parts);

// The volume of a part by the corners of the cell to which its mass goes, m^3.
std::array<double, 8> part_volumes(const CellCorners& corners, const Vector3& low, const Vector3& high);

// Young's modulus and Poisson's ratio of a cell of this stiffness along x, y and z: what it resists to even
// strains.
AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellMatrix& stiffness);

// The gradients of the trilinear shape functions in the middle of the cell, one row a corner, 1/m.
using CellGradients = Eigen::Matrix<double, 8, 3>;
CellGradients middle_gradients(const CellCorners& corners);

}  // namespace spoonbill
