// Body coordinates of a lattice's nodes, cells and faces: position along the body, position around it, and
// depth below its surface.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Returns the body coordinates of each node at rest. The depth is the distance to the hull of the block.
// `along` is the fraction of the block's length along k. If the lattice is a box of cells around a surface,
// the depth is the distance to the surface, and `along` is the position along the surface; nodes outside the
// body have NaN coordinates and are in no region. `around` is 0 if LatticeMesh::turns is empty.
std::vector<BodyCoordinates> find_node_coordinates(const LatticeMesh& mesh);

// Returns the mean body coordinates of the nodes `selected`; `nodes` has the coordinates of all nodes. The
// mean of `around` is weighted by the nodes' distances from the centre line, and is 0 if the nodes surround
// that line. The depth is not set.
//
// Uses sums only: the C library's trigonometric functions differ between processors, and the assignment of
// cells to regions must not differ.
BodyCoordinates mean_coordinates(const LatticeMesh& mesh, const std::vector<BodyCoordinates>& nodes,
                                 std::span<const int> selected);

// Returns the body coordinates of all cells, indexed by LatticeMesh::cell_index(). The depth is that of the
// cell's centre; the other coordinates are the mean_coordinates() of its corners. If the lattice is a box of
// cells around a surface, returns LatticeMesh::cell_centres.
std::vector<BodyCoordinates> find_cell_coordinates(const LatticeMesh& mesh);

// Nodes of a boundary quad of the block, counter-clockwise seen from outside.
using ShellFace = std::array<int, 4>;

// Returns the faces of the block's hull. If the body fills its block, pressure acts on these faces and areas
// are measured on them; a body in a box of cells has a BodySkin instead.
std::vector<ShellFace> shell_faces(const LatticeMesh& mesh);

// Returns the faces whose mean_coordinates() are in the region. `coordinates` are those of all nodes of the
// lattice.
std::vector<ShellFace> find_faces_in(const BodyRegion& region, const LatticeMesh& mesh,
                                     const std::vector<ShellFace>& faces,
                                     const std::vector<BodyCoordinates>& coordinates);

// Returns half the cross product of the diagonals, m^2, pointing outward: the exact vector area of a
// bilinear patch.
inline Vector3 vector_area(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return 0.5 * (c - a).cross(d - b);
}

}  // namespace spoonbill
