// The quads that bound a block of cells that is the body: what bears pressure, and what an area of the body
// is counted by. A body in a box of cells has a BodySkin for that.
#pragma once

#include <array>
#include <vector>

#include "engine/material/lattice/body_place.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Nodes, counter-clockwise seen from outside.
using ShellFace = std::array<int, 4>;

// The faces of the block's hull.
std::vector<ShellFace> shell_faces(const LatticeMesh& mesh);

// Those whose middle is in the region; `places` are the nodes'.
std::vector<ShellFace> faces_in(const BodyRegion& region, const LatticeMesh& mesh,
                                const std::vector<ShellFace>& faces, const std::vector<BodyCoordinates>& places);

// Half the product of the diagonals, m^2, outward: a pressure on it is exactly that of a bilinear patch.
inline Vector3 vector_area(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return 0.5 * (c - a).cross(d - b);
}

}  // namespace spoonbill
