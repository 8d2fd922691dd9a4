// Parameters of graph nodes from harmonic functions: v rises from one end of the shape to the other, u runs
// around. A harmonic function has no interior extremum (discrete maximum principle). Lines of constant v are
// therefore single rings on surfaces without handles; see Gu and Yau (2003) for maps of such surfaces.
#pragma once

#include <array>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {

// Ends of a shape, at v = 0 and v = 1: each is a pole of one node, or the nodes of a boundary loop.
struct ShapeEnds {
  std::vector<std::uint32_t> start, end;
};

// Returns (u, v) in [0, 1] for each node of a connected graph, periodic in u. Both are harmonic functions. v
// is then rescaled to follow the path length from start to end. Near poles u is NaN, because the nodes are
// too coarse to resolve it there. Fails if the graph is not connected from end to end, or if u does not
// increase by 1 on a path around the shape, for example because the ends touch.
Result<std::vector<Vector2>> harmonic_tube_map(const PointGraph& graph, const ShapeEnds& ends);

// Maps a disc onto the unit square by Tutte's embedding. The nodes of `loop`, in order, map to the sides of
// the square by arc length. corners[0] maps to (0, 0), the other corners to the other vertices of the square,
// in the order of the loop.
Result<std::vector<Vector2>> harmonic_square_map(const PointGraph& graph,
                                                 const std::vector<std::uint32_t>& loop,
                                                 const std::array<std::size_t, 4>& corners);

// Returns two nodes with nearly the largest path distance between them.
ShapeEnds farthest_ends(const PointGraph& graph);

}  // namespace spoonbill
