// Lattice cells as eight-node hexahedra that can bend, for cases where springs fail (Poisson's ratios below
// 1/4, slender cells) or would need too many cells (beams).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "engine/material/cells/cell_elasticity.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Returns the stiffness of a cell: the matrix that maps small displacements, m, to forces, N, in the axes of
// the rest shape. It is symmetric, and the six rigid motions span its null space.
//
// The element is trilinear, with three quadratic displacement modes per axis that are internal to the cell
// and condensed out. A plain trilinear cell shears in bending and is too stiff. A beam of L/H = 10 with a
// single such cell through its height is too stiff by half. It also locks near nu = 1/2 (Wilson et al. 1973).
//
// The gradients of the internal modes use the Jacobian at the cell's centre, so that distorted cells pass the
// patch test (Taylor, Beresford and Wilson 1976). The integral uses two Gauss points per axis. The cell must
// not be folded; -1 < nu < 1/2.
CellMatrix hexahedron_stiffness(const CellCorners& corners, double youngs_modulus_pa, double poissons_ratio);

// Part of a cell with its own elasticity: a box in the cell's natural coordinates, which run from -1 to 1
// along i, j and k.
struct HexahedronPart {
  Vector3 low = -Vector3::Ones(), high = Vector3::Ones();
  double youngs_modulus_pa = 0.0, poissons_ratio = 0.0;
};

// Returns the stiffness of a cell that consists of several parts. Each part has its own Gauss points, so that
// layers bend as a composite does.
CellMatrix hexahedron_stiffness(const CellCorners& corners, std::span<const HexahedronPart> parts);

// Returns the volume of a part of a cell, m^3, divided among the cell's corners as its mass is.
std::array<double, 8> part_volumes(const CellCorners& corners, const Vector3& low, const Vector3& high);

// Returns Young's modulus and Poisson's ratio of a cell with this stiffness along x, y and z, for uniform
// strains.
AchievedElasticity achieved_elasticity(const CellCorners& corners, const CellMatrix& stiffness);

// Gradients of a cell's shape functions, one row per corner, 1/m.
using CellGradients = Eigen::Matrix<double, 8, 3>;
// Returns the gradients of the trilinear shape functions at the centre of the cell.
CellGradients centre_gradients(const CellCorners& corners);

}  // namespace spoonbill
