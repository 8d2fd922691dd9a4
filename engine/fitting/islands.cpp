#include "engine/fitting/islands.h"

#include <algorithm>
#include <numeric>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

FitPoints island_of(const FitPoints& whole, const std::vector<std::uint32_t>& part_of_node,
                    std::uint32_t part) {
  std::vector<std::uint32_t> nodes, place(whole.graph.size(), 0);
  FitPoints island;
  island.is_mesh = whole.is_mesh;
  for (std::uint32_t n = 0; n < whole.graph.size(); ++n) {
    if (part_of_node[n] != part) continue;
    place[n] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(n);
    island.node_normals.push_back(whole.node_normals[n]);
  }
  island.graph = part_of(whole.graph, nodes);
  std::vector<std::uint32_t> point_place(whole.node_of.size(), no_point);
  for (std::size_t p = 0; p < whole.node_of.size(); ++p) {
    if (part_of_node[whole.node_of[p]] != part) continue;
    point_place[p] = static_cast<std::uint32_t>(island.node_of.size());
    island.scan.points_m.push_back(whole.scan.points_m[p]);
    if (whole.scan.has_normals()) island.scan.normals.push_back(whole.scan.normals[p]);
    island.weights.push_back(whole.weights[p]);
    island.node_of.push_back(place[whole.node_of[p]]);
  }
  for (std::size_t g = 0; g < whole.given_m.size(); ++g) {
    const std::uint32_t point = whole.stands_for[g];
    if (point == no_point || point_place[point] == no_point) continue;
    island.given_m.push_back(whole.given_m[g]);
    island.stands_for.push_back(point_place[point]);
  }
  for (const Rim& rim : whole.rims) {
    if (part_of_node[rim.nodes.front()] != part) continue;
    island.rims.push_back(rim);
    for (std::uint32_t& node : island.rims.back().nodes) node = place[node];
  }
  return island;
}

}  // namespace

Islands split_islands(const FitPoints& points) {
  SPOONBILL_ASSERT(points.node_of.size() == points.scan.points_m.size());
  const GraphParts parts = connected_parts(points.graph);
  std::vector<double> weights(parts.sizes.size(), 0.0);
  std::vector<std::size_t> counts(parts.sizes.size(), 0);
  for (std::size_t p = 0; p < points.node_of.size(); ++p) {
    weights[parts.part_of[points.node_of[p]]] += points.weights[p];
  }
  for (const std::uint32_t point : points.stands_for) {
    if (point != no_point) ++counts[parts.part_of[points.node_of[point]]];
  }
  std::vector<std::uint32_t> order(weights.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return weights[a] > weights[b]; });
  Islands result;
  for (const std::uint32_t part : order) {
    const bool is_dust =
        weights[part] < dust_share * weights[order.front()] || parts.sizes[part] < least_island_nodes;
    if (is_dust) {
      result.dust_points += counts[part];
    } else {
      result.islands.push_back(island_of(points, parts.part_of, part));
    }
  }
  return result;
}

}  // namespace spoonbill
