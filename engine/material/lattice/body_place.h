// Where the nodes and cells of a lattice are in the body's own coordinates.
#pragma once

#include <span>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/material.h"

namespace spoonbill {

// One of each node, at rest. The depth is the distance to the faces of the block's hull, in a box about a
// surface that to the surface; nodes beside the body are in no region. Of a block that is no tube, shares
// count along the block, and around is 0.
std::vector<BodyCoordinates> node_places(const LatticeMesh& mesh);

// Of some of the nodes, of which all places are given: the mean of their shares along, and of their turns, of
// which one counts the more the further out it is; around is 0 where they lie about the axis. Without a
// depth. By sums alone: the C library's directions differ with the processor, and what holds a cell enters
// the state.
BodyCoordinates mean_place(const LatticeMesh& mesh, const std::vector<BodyCoordinates>& nodes, std::span<const int> of);

// One of each cell, of its middle, by LatticeMesh::cell_index(): its own depth, and the mean_place() of its
// corners; in a box about a surface LatticeMesh::middles.
std::vector<BodyCoordinates> cell_places(const LatticeMesh& mesh);

}  // namespace spoonbill
