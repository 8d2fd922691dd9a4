// Moves the nodes inside a block until no cell is folded over, where the block's hull lets that be.
#pragma once

#include <vector>

#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Boolean sum of the linear interpolations between the three pairs of faces (Gordon and Hall 1973), of the
// two across where the block is closed: puts every node that is not on the hull.
void fill_from_hull(LatticeMesh& mesh);

// Node by node, sweep by sweep, towards the least sum over the corners of |S|^3 / (3^1.5 h(det S)): S has
// the corner's edges as columns, each over the block's mean edge in its direction, and h(x) =
// (x + sqrt(x^2 + 4 d^2)) / 2 keeps the sum finite while cells are folded (Escobar et al. 2003; Knupp 2001
// for the measure). For d = 0 a corner's term is convex in the place of a node, since det S is affine in it.
// Moves only the nodes of `movable`, no second of a place among them; the same block gives the same bits. The
// caller looks at what is left.
void unfold(LatticeMesh& mesh, const std::vector<int>& movable);

// The smallest Jacobian determinant over the corners and the eight Gauss points of all cells, each over its
// cell's volume; -1 where a cell has none.
double smallest_jacobian_ratio(const LatticeMesh& mesh);

}  // namespace spoonbill
