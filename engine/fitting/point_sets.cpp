#include "engine/fitting/point_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>
#include <queue>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
struct NearestPoints::Tree {
  struct Points {
    std::span<const Vector3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t index, std::size_t axis) const {
      return points[index][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3,
                                                    std::uint32_t>;

  explicit Tree(std::span<const Vector3> given)
      : points{given}, index(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}

  Points points;
  Index index;
};

NearestPoints::NearestPoints(std::span<const Vector3> points) : tree_(std::make_unique<Tree>(points)) {
  SPOONBILL_ASSERT(!points.empty());
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(points.begin(), points.end(), [](const Vector3& at) { return at.allFinite(); }));
}
NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

NearestPoints::Neighbour NearestPoints::nearest(const Vector3& position) const {
  Neighbour found;
  tree_->index.knnSearch(position.data(), 1, &found.index, &found.distance);
  found.distance = std::sqrt(found.distance);
  return found;
}

void NearestPoints::nearest(const Vector3& position, std::size_t count, std::vector<Neighbour>& found) const {
  thread_local std::vector<std::uint32_t> indices;
  thread_local std::vector<double> squares;
  indices.resize(count);
  squares.resize(count);
  const std::size_t found_count =
      tree_->index.knnSearch(position.data(), count, indices.data(), squares.data());
  found.resize(found_count);
  for (std::size_t k = 0; k < found_count; ++k) found[k] = {indices[k], std::sqrt(squares[k])};
}

PointGraph make_point_graph(std::vector<Vector3> points_m, const std::vector<NodePair>& pairs) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(pairs.begin(), pairs.end(), [&](const NodePair& pair) {
    return pair.first < points_m.size() && pair.second < points_m.size();
  }));
  std::vector<NodePair> both;
  both.reserve(2 * pairs.size());
  for (const auto& [a, b] : pairs) {
    if (a == b) continue;
    both.emplace_back(a, b);
    both.emplace_back(b, a);
  }
  std::sort(both.begin(), both.end());
  both.erase(std::unique(both.begin(), both.end()), both.end());
  PointGraph graph;
  graph.points_m = std::move(points_m);
  graph.first.assign(graph.size() + 1, 0);
  graph.neighbours.reserve(both.size());
  for (const auto& [a, b] : both) {
    ++graph.first[a + 1];
    graph.neighbours.push_back(b);
  }
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  return graph;
}

PointGraph induced_subgraph(const PointGraph& graph, const std::vector<std::uint32_t>& nodes) {
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return node < graph.size(); }));
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> index(graph.size(), none);
  std::vector<Vector3> points;
  points.reserve(nodes.size());
  for (const std::uint32_t node : nodes) {
    index[node] = static_cast<std::uint32_t>(points.size());
    points.push_back(graph.points_m[node]);
  }
  std::vector<NodePair> pairs;
  for (const std::uint32_t node : nodes) {
    for (const std::uint32_t other : graph.adjacent(node)) {
      if (other > node && index[other] != none) pairs.emplace_back(index[node], index[other]);
    }
  }
  return make_point_graph(std::move(points), pairs);
}

ConnectedComponents connected_components(const PointGraph& graph) {
  constexpr std::uint32_t none = 0xffffffffU;
  ConnectedComponents parts;
  parts.component.assign(graph.size(), none);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t start = 0; start < graph.size(); ++start) {
    if (parts.component[start] != none) continue;
    const auto part = static_cast<std::uint32_t>(parts.sizes.size());
    parts.sizes.push_back(0);
    parts.component[start] = part;
    waiting.push_back(start);
    while (!waiting.empty()) {
      const std::uint32_t node = waiting.back();
      waiting.pop_back();
      ++parts.sizes[part];
      for (const std::uint32_t other : graph.adjacent(node)) {
        if (parts.component[other] != none) continue;
        parts.component[other] = part;
        waiting.push_back(other);
      }
    }
  }
  std::vector<std::uint32_t> order(parts.sizes.size()), rank(parts.sizes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return parts.sizes[a] > parts.sizes[b]; });
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  for (std::uint32_t& part : parts.component) part = rank[part];
  std::sort(parts.sizes.rbegin(), parts.sizes.rend());
  return parts;
}

ShortestPaths shortest_paths(const PointGraph& graph, std::span<const std::uint32_t> sources) {
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(sources.begin(), sources.end(), [&](std::uint32_t node) { return node < graph.size(); }));
  ShortestPaths paths;
  paths.length.assign(graph.size(), std::numeric_limits<double>::infinity());
  paths.predecessor.resize(graph.size());
  std::iota(paths.predecessor.begin(), paths.predecessor.end(), 0U);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (const std::uint32_t source : sources) {
    paths.length[source] = 0.0;
    waiting.emplace(0.0, source);
  }
  while (!waiting.empty()) {
    const auto [length, node] = waiting.top();
    waiting.pop();
    if (length > paths.length[node]) continue;
    for (const std::uint32_t other : graph.adjacent(node)) {
      const double reached = length + graph.length(node, other);
      if (reached >= paths.length[other]) continue;
      paths.length[other] = reached;
      paths.predecessor[other] = node;
      waiting.emplace(reached, other);
    }
  }
  return paths;
}

double mean_edge_length(const PointGraph& graph) {
  SPOONBILL_ASSERT(graph.first.size() == graph.size() + 1);
  double sum = 0.0;
  for (std::uint32_t node = 0; node < graph.size(); ++node) {
    for (const std::uint32_t other : graph.adjacent(node)) sum += graph.length(node, other);
  }
  return graph.neighbours.empty() ? 0.0 : sum / static_cast<double>(graph.neighbours.size());
}

}  // namespace spoonbill
