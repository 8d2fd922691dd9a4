// Embedding of points in the cells of a lattice that follows a body's shape. For a box of cells, see
// box_lattice.h.
#pragma once

#include "engine/base/geometry.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Embeds a point in a cell. Considers the cells around the nearest node and around that node's twin across a
// seam, and chooses the one that contains the point or, if none does, the one nearest to it. If the chosen
// cell is more than one cell size away, the point follows the mean motion of one of these cells, or the
// nearest node alone if that would take too large weights.
EmbeddedPoint embed_in_mesh(const LatticeMesh& mesh, const Vector3& point);

}  // namespace spoonbill
