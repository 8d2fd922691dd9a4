// Edges of a surface that are a single point, such as poles.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/bspline/surface.h"

namespace spoonbill {

// Largest extent of an edge that counts as a point, as a fraction of the control net's size. The points of a
// pole may be this far apart because of single precision or because another program wrote them.
inline constexpr double collapsed_edge_fraction = 1e-6;

// Control points that belong to one edge: `count` of them from index `first` on, `stride` apart.
struct NetEdge {
  std::size_t first = 0, stride = 1, count = 0;
};

// Returns the control points of an edge: a row at an end of u if `of_u`, otherwise a column at an end of v.
// The edge is at the end of the domain if `at_end`, otherwise at its start.
NetEdge find_edge(const ControlNet& net, bool of_u, bool at_end);

// Returns true if the control points of the edge coincide up to collapsed_edge_fraction.
bool is_collapsed(const ControlNet& net, const NetEdge& edge);

// Returns the edges at clamped ends whose control points coincide up to collapsed_edge_fraction.
std::vector<NetEdge> find_collapsed_edges(const Surface& surface);

// Moves the control points of an edge to their mean, unless they already coincide exactly. Returns true if a
// point moved. Does not allocate.
bool join_edge(ControlNet& net, const NetEdge& edge);

// Moves the control points of each collapsed edge to their mean. Returns true if a point moved.
bool join_collapsed_edges(Surface& surface);

}  // namespace spoonbill
