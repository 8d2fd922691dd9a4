// Points and which of them are neighbours: what stands for a surface before there is one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

using NodePair = std::pair<std::uint32_t, std::uint32_t>;

// Neighbours of node n: neighbours[first[n]] to neighbours[first[n + 1]], without itself or repetition.
struct PointGraph {
  std::vector<Vector3> points_m;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> neighbours;

  std::size_t size() const { return points_m.size(); }
  std::span<const std::uint32_t> of(std::uint32_t node) const {
    return {neighbours.data() + first[node], neighbours.data() + first[node + 1]};
  }
  double length(std::uint32_t a, std::uint32_t b) const { return (points_m[a] - points_m[b]).norm(); }
};

// Each pair once or twice, in either order.
PointGraph make_point_graph(std::vector<Vector3> points_m, const std::vector<NodePair>& pairs);

// The nodes given alone, in their order, and the pairs between them.
PointGraph part_of(const PointGraph& graph, const std::vector<std::uint32_t>& nodes);

// Which connected part each node belongs to, numbered from the one with most nodes on.
struct GraphParts {
  std::vector<std::uint32_t> part_of;
  std::vector<std::size_t> sizes;
};
GraphParts connected_parts(const PointGraph& graph);

// Lengths of the shortest ways along edges from any of the sources, infinite where there is none, and the
// node before each on its way (itself at a source).
struct ShortestWays {
  std::vector<double> length;
  std::vector<std::uint32_t> before;
};
ShortestWays shortest_ways(const PointGraph& graph, std::span<const std::uint32_t> sources);

double mean_edge_length(const PointGraph& graph);

}  // namespace spoonbill
