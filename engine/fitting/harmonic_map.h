// Parameters for the nodes of a graph by harmonic functions on it: v rises from one end of the shape to the
// other, u runs around. A harmonic function has no extremum between its ends, so that the lines of constant v
// are single rings wherever the graph is close to a surface without handles (the discrete maximum principle;
// Gu and Yau 2003 for maps of such surfaces).
#pragma once

#include <array>
#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/point_graph.h"

namespace spoonbill {

// Where v begins and ends: a pole of one node, or the nodes of an open rim.
struct ShapeEnds {
  std::vector<std::uint32_t> start, end;
};

// For each node of a connected graph its (u, v) in 0..1, u periodic; NaN close to poles, where u turns within
// an edge. v is spread by the length of the way from start to end, u as the harmonic function spreads it.
// Refused: ends that touch, a graph on which u does not close.
Result<std::vector<Vector2>> harmonic_tube_map(const PointGraph& graph, const ShapeEnds& ends);

// The map of a disc onto the square, its rim (in order) to the square's sides by arc length, the first node
// of `corners` to (0, 0) and so on around: Tutte's embedding.
Result<std::vector<Vector2>> harmonic_square_map(const PointGraph& graph,
                                                 const std::vector<std::uint32_t>& rim,
                                                 const std::array<std::size_t, 4>& corners);

// The two nodes farthest from each other along the graph, or nearly so.
ShapeEnds farthest_ends(const PointGraph& graph);

}  // namespace spoonbill
