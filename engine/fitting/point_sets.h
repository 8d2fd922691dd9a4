// Tools for point sets: quantiles, nearest-neighbour search, neighbour graphs, shortest paths.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {

// Returns the value below which the given fraction (0 to 1) of the values are; 0 for an empty list.
inline double quantile(std::vector<double> values, double fraction) {
  SPOONBILL_ASSERT(fraction >= 0.0 && fraction <= 1.0);
  if (values.empty()) return 0.0;
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

inline double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

// k-d tree over points that the caller owns. The points must stay unchanged and outlive the tree. Thread-safe
// for reading.
class NearestPoints {
 public:
  // `points` must be finite and not empty.
  explicit NearestPoints(std::span<const Vector3> points);
  ~NearestPoints();
  NearestPoints(NearestPoints&&) noexcept;
  NearestPoints& operator=(NearestPoints&&) noexcept;

  struct Neighbour {
    std::uint32_t index = 0;
    double distance = 0.0;
  };
  Neighbour nearest(const Vector3& position) const;
  // Finds at most `count` neighbours, nearest first.
  void nearest(const Vector3& position, std::size_t count, std::vector<Neighbour>& found) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

using NodePair = std::pair<std::uint32_t, std::uint32_t>;

// Undirected graph over points. The neighbours of node n are neighbours[first[n]] up to, but not including,
// neighbours[first[n + 1]], sorted, without n itself or duplicates.
struct PointGraph {
  std::vector<Vector3> points_m;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> neighbours;

  std::size_t size() const { return points_m.size(); }
  std::span<const std::uint32_t> adjacent(std::uint32_t node) const {
    return {neighbours.data() + first[node], neighbours.data() + first[node + 1]};
  }
  double length(std::uint32_t a, std::uint32_t b) const { return (points_m[a] - points_m[b]).norm(); }
};

// Builds a graph with an edge for each pair. Pairs may occur repeatedly and in either order.
PointGraph make_point_graph(std::vector<Vector3> points_m, const std::vector<NodePair>& pairs);

// Returns the graph that consists of the given nodes, in the given order, and of the edges between them.
PointGraph induced_subgraph(const PointGraph& graph, const std::vector<std::uint32_t>& nodes);

// Component of each node; components are numbered by decreasing node count.
struct ConnectedComponents {
  std::vector<std::uint32_t> component;
  std::vector<std::size_t> sizes;
};
ConnectedComponents connected_components(const PointGraph& graph);

// Shortest paths from any of the sources: the length of each node's path (infinite if unreachable) and the
// node's predecessor on it (the node itself at a source).
struct ShortestPaths {
  std::vector<double> length;
  std::vector<std::uint32_t> predecessor;
};
ShortestPaths shortest_paths(const PointGraph& graph, std::span<const std::uint32_t> sources);

double mean_edge_length(const PointGraph& graph);

}  // namespace spoonbill
