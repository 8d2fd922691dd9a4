#include "engine/fitting/point_graph.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

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

PointGraph part_of(const PointGraph& graph, const std::vector<std::uint32_t>& nodes) {
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return node < graph.size(); }));
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> place(graph.size(), none);
  std::vector<Vector3> points;
  points.reserve(nodes.size());
  for (const std::uint32_t node : nodes) {
    place[node] = static_cast<std::uint32_t>(points.size());
    points.push_back(graph.points_m[node]);
  }
  std::vector<NodePair> pairs;
  for (const std::uint32_t node : nodes) {
    for (const std::uint32_t other : graph.of(node)) {
      if (other > node && place[other] != none) pairs.emplace_back(place[node], place[other]);
    }
  }
  return make_point_graph(std::move(points), pairs);
}

GraphParts connected_parts(const PointGraph& graph) {
  constexpr std::uint32_t none = 0xffffffffU;
  GraphParts parts;
  parts.part_of.assign(graph.size(), none);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t start = 0; start < graph.size(); ++start) {
    if (parts.part_of[start] != none) continue;
    const auto part = static_cast<std::uint32_t>(parts.sizes.size());
    parts.sizes.push_back(0);
    parts.part_of[start] = part;
    waiting.push_back(start);
    while (!waiting.empty()) {
      const std::uint32_t node = waiting.back();
      waiting.pop_back();
      ++parts.sizes[part];
      for (const std::uint32_t other : graph.of(node)) {
        if (parts.part_of[other] != none) continue;
        parts.part_of[other] = part;
        waiting.push_back(other);
      }
    }
  }
  std::vector<std::uint32_t> order(parts.sizes.size()), rank(parts.sizes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return parts.sizes[a] > parts.sizes[b]; });
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  for (std::uint32_t& part : parts.part_of) part = rank[part];
  std::sort(parts.sizes.rbegin(), parts.sizes.rend());
  return parts;
}

ShortestWays shortest_ways(const PointGraph& graph, std::span<const std::uint32_t> sources) {
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(sources.begin(), sources.end(), [&](std::uint32_t node) { return node < graph.size(); }));
  ShortestWays ways;
  ways.length.assign(graph.size(), std::numeric_limits<double>::infinity());
  ways.before.resize(graph.size());
  std::iota(ways.before.begin(), ways.before.end(), 0U);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  for (const std::uint32_t source : sources) {
    ways.length[source] = 0.0;
    waiting.emplace(0.0, source);
  }
  while (!waiting.empty()) {
    const auto [length, node] = waiting.top();
    waiting.pop();
    if (length > ways.length[node]) continue;
    for (const std::uint32_t other : graph.of(node)) {
      const double reached = length + graph.length(node, other);
      if (reached >= ways.length[other]) continue;
      ways.length[other] = reached;
      ways.before[other] = node;
      waiting.emplace(reached, other);
    }
  }
  return ways;
}

double mean_edge_length(const PointGraph& graph) {
  SPOONBILL_ASSERT(graph.first.size() == graph.size() + 1);
  double sum = 0.0;
  for (std::uint32_t node = 0; node < graph.size(); ++node) {
    for (const std::uint32_t other : graph.of(node)) sum += graph.length(node, other);
  }
  return graph.neighbours.empty() ? 0.0 : sum / static_cast<double>(graph.neighbours.size());
}

}  // namespace spoonbill
