// A part of a body in the body's own coordinates, so that it stays where it is however the body is bent: what
// has a material or a friction of its own, is loaded, or is held.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/range.h"
#include "engine/result.h"

namespace spoonbill {

// Plain data. All of the body as it is made.
struct BodyRegion {
  Range<double> along{0.0, 1.0};   // of the body's length in the sense of v; of a ring, of its turn
  Range<double> around{0.0, 1.0};  // of a turn in the sense of u; low above high: across the seam
  Range<double> depth_m{0.0, std::numeric_limits<double>::infinity()};  // below the surface, at rest
};

bool contains(const BodyRegion& region, const BodyPlace& place);

// One of each node, at rest. The depth is the distance to the faces of the block's hull, in a box about a
// surface that to the surface; nodes beside the body are in no region. Of a block that is no tube, shares
// count along the block, and around is 0.
std::vector<BodyPlace> node_places(const LatticeMesh& mesh);

// Of some of the nodes, of which all places are given: the mean of their shares along, and of their turns, of
// which one counts the more the further out it is; around is 0 where they lie about the axis. Without a
// depth. By sums alone: the C library's directions differ with the processor, and what holds a cell enters
// the state.
BodyPlace mean_place(const LatticeMesh& mesh, const std::vector<BodyPlace>& nodes, std::span<const int> of);

// One of each cell, of its middle, by LatticeMesh::cell_index(): its own depth, and the mean_place() of its
// corners; in a box about a surface LatticeMesh::middles.
std::vector<BodyPlace> cell_places(const LatticeMesh& mesh);

// The shares within 0 to 1 and in order, the depths at least 0 and in order; the message names the field.
Status check_region(const BodyRegion& region);

}  // namespace spoonbill
