#include "engine/fitting/islands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

// A pair of nodes may bridge a gap if its length exceeds the median length of the pairs by this factor.
constexpr double doubtful_length = 1.5;
// A gap between two nodes is at least this many times as wide as the widest step between the points of either
// node. The widest step is the longest edge of the points' minimum spanning tree. Random points within one
// surface have no gap as wide as this.
constexpr double gap_steps = 3.0;
// Smallest cosine of the angle between the direction across a gap and the normal on either side (45 degrees).
constexpr double facing_fraction = 0.7;
constexpr std::size_t least_around = 5;
// Smallest number of points that a node must have if a gap is to be measured from the spacing of its points.
constexpr std::size_t least_island_points = 3;
// Largest number of points of a node that are compared. If a node has more, a regular subset is used.
constexpr std::size_t most_points = 64;

// Returns the direction in which a node and its neighbours spread least, which is normal to the surface.
// Returns zero with fewer than five neighbours.
Vector3 normal_at(const PointGraph& graph, std::uint32_t node) {
  const auto around = graph.adjacent(node);
  if (around.size() < least_around) return Vector3::Zero();
  Vector3 centre = graph.points_m[node];
  for (const std::uint32_t near : around) centre += graph.points_m[near];
  centre /= static_cast<double>(around.size() + 1);
  const Vector3 own = graph.points_m[node] - centre;
  Eigen::Matrix3d scatter = own * own.transpose();
  for (const std::uint32_t near : around) {
    const Vector3 offset = graph.points_m[near] - centre;
    scatter += offset * offset.transpose();
  }
  return decompose_symmetric(scatter).vectors.col(0);
}

bool faces_both(const PointGraph& graph, const NodePair& pair) {
  const Vector3 offset = (graph.points_m[pair.second] - graph.points_m[pair.first]).stableNormalized();
  return std::abs(offset.dot(normal_at(graph, pair.first))) > facing_fraction &&
         std::abs(offset.dot(normal_at(graph, pair.second))) > facing_fraction;
}

class NodePoints {
 public:
  NodePoints(const std::vector<Vector3>& points_m, const VoxelGroups& groups) : points_(groups.count) {
    for (std::size_t p = 0; p < points_m.size(); ++p) points_[groups.group_index[p]].push_back(points_m[p]);
    for (std::vector<Vector3>& points : points_) {
      if (points.size() <= most_points) continue;
      const std::size_t stride = 1 + points.size() / most_points;
      for (std::size_t k = 0; k * stride < points.size(); ++k) points[k] = points[k * stride];
      points.resize(1 + (points.size() - 1) / stride);
    }
  }

  bool bridges_gap(const NodePair& pair) const {
    const std::vector<Vector3>&first = points_[pair.first], &second = points_[pair.second];
    if (first.size() < least_island_points || second.size() < least_island_points) return false;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3& a : first) {
      for (const Vector3& b : second) nearest = std::min(nearest, (a - b).norm());
    }
    return nearest > gap_steps * std::max(widest_step(first), widest_step(second));
  }

 private:
  // Returns the longest edge of the minimum spanning tree of the points (Prim 1957).
  static double widest_step(const std::vector<Vector3>& points) {
    std::vector<double> away(points.size(), std::numeric_limits<double>::infinity());
    std::vector<bool> reached(points.size(), false);
    std::size_t last = 0;
    double widest = 0.0;
    for (std::size_t count = 1; count < points.size(); ++count) {
      reached[last] = true;
      std::size_t next = last;
      for (std::size_t p = 0; p < points.size(); ++p) {
        if (reached[p]) continue;
        away[p] = std::min(away[p], (points[p] - points[last]).norm());
        if (next == last || away[p] < away[next]) next = p;
      }
      widest = std::max(widest, away[next]);
      last = next;
    }
    return widest;
  }

  std::vector<std::vector<Vector3>> points_;
};

std::vector<double> pair_lengths(const std::vector<Vector3>& nodes_m, const std::vector<NodePair>& pairs) {
  std::vector<double> lengths;
  lengths.reserve(pairs.size());
  for (const auto& [a, b] : pairs) lengths.push_back((nodes_m[a] - nodes_m[b]).norm());
  return lengths;
}

// Returns the body to which each component belongs. A component that is too small for a body (dust) belongs
// to the body at the other end of its shortest pair of nodes, or to no_point if no pair leads to a body. Any
// other component is a body itself.
std::vector<std::uint32_t> assign_bodies(const ConnectedComponents& parts,
                                         const std::vector<std::size_t>& component_points,
                                         const std::vector<NodePair>& pairs,
                                         const std::vector<double>& lengths) {
  const std::size_t most = *std::max_element(component_points.begin(), component_points.end());
  std::vector<std::uint32_t> body(parts.sizes.size());
  std::vector<double> nearest(parts.sizes.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> is_dust(parts.sizes.size());
  for (std::uint32_t part = 0; part < body.size(); ++part) {
    is_dust[part] = parts.sizes[part] < least_island_nodes ||
                    static_cast<double>(component_points[part]) < dust_fraction * static_cast<double>(most);
    body[part] = is_dust[part] ? no_point : part;
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::uint32_t a = parts.component[pairs[k].first], b = parts.component[pairs[k].second];
    for (const auto& [dust, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (!is_dust[dust] || is_dust[other] || !(lengths[k] < nearest[dust])) continue;
      nearest[dust] = lengths[k];
      body[dust] = other;
    }
  }
  return body;
}

}  // namespace

std::vector<NodePair> remove_gap_pairs(const std::vector<Vector3>& points_m, const VoxelGroups& groups,
                                       const std::vector<Vector3>& nodes_m, std::vector<NodePair> pairs) {
  SPOONBILL_ASSERT(groups.group_index.size() == points_m.size() && groups.count == nodes_m.size());
  if (pairs.empty()) return pairs;
  const std::vector<double> lengths = pair_lengths(nodes_m, pairs);
  const double doubtful = doubtful_length * median(lengths);
  std::vector<NodePair> firm;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= doubtful) firm.push_back(pairs[k]);
  }
  const PointGraph near_graph = make_point_graph(nodes_m, firm);
  const ConnectedComponents near_parts = connected_components(near_graph);
  if (near_parts.sizes.size() == 1) return pairs;
  const NodePoints points(points_m, groups);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto& [a, b] = pairs[k];
    if (near_parts.component[a] == near_parts.component[b]) continue;
    if (!faces_both(near_graph, pairs[k]) || !points.bridges_gap(pairs[k])) firm.push_back(pairs[k]);
  }
  const ConnectedComponents parts = connected_components(make_point_graph(nodes_m, firm));
  std::vector<std::size_t> component_points(parts.sizes.size(), 0);
  for (const std::uint32_t node : groups.group_index) ++component_points[parts.component[node]];
  const std::vector<std::uint32_t> body = assign_bodies(parts, component_points, pairs, lengths);
  std::erase_if(pairs, [&](const NodePair& pair) {
    const std::uint32_t first = body[parts.component[pair.first]],
                        second = body[parts.component[pair.second]];
    return first != second && first != no_point && second != no_point;
  });
  return pairs;
}

namespace {

FitPoints extract_island(const FitPoints& whole, const std::vector<std::uint32_t>& node_component,
                         std::uint32_t part) {
  std::vector<std::uint32_t> nodes, new_node(whole.graph.size(), 0);
  FitPoints island;
  island.is_mesh = whole.is_mesh;
  for (std::uint32_t n = 0; n < whole.graph.size(); ++n) {
    if (node_component[n] != part) continue;
    new_node[n] = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back(n);
    island.node_normals.push_back(whole.node_normals[n]);
  }
  island.graph = induced_subgraph(whole.graph, nodes);
  std::vector<std::uint32_t> new_point(whole.node_index.size(), no_point);
  for (std::size_t p = 0; p < whole.node_index.size(); ++p) {
    if (node_component[whole.node_index[p]] != part) continue;
    new_point[p] = static_cast<std::uint32_t>(island.node_index.size());
    island.scan.points_m.push_back(whole.scan.points_m[p]);
    if (whole.scan.has_normals()) island.scan.normals.push_back(whole.scan.normals[p]);
    island.weights.push_back(whole.weights[p]);
    island.node_index.push_back(new_node[whole.node_index[p]]);
  }
  for (std::size_t g = 0; g < whole.given_m.size(); ++g) {
    const std::uint32_t point = whole.representative[g];
    if (point == no_point || new_point[point] == no_point) continue;
    island.given_m.push_back(whole.given_m[g]);
    island.representative.push_back(new_point[point]);
  }
  for (const BoundaryLoop& loop : whole.boundary_loops) {
    if (node_component[loop.nodes.front()] != part) continue;
    island.boundary_loops.push_back(loop);
    for (std::uint32_t& node : island.boundary_loops.back().nodes) node = new_node[node];
  }
  return island;
}

}  // namespace

Islands split_islands(const FitPoints& points) {
  SPOONBILL_ASSERT(points.node_index.size() == points.scan.points_m.size());
  const ConnectedComponents parts = connected_components(points.graph);
  std::vector<double> weights(parts.sizes.size(), 0.0);
  std::vector<std::size_t> counts(parts.sizes.size(), 0);
  for (std::size_t p = 0; p < points.node_index.size(); ++p) {
    weights[parts.component[points.node_index[p]]] += points.weights[p];
  }
  for (const std::uint32_t point : points.representative) {
    if (point != no_point) ++counts[parts.component[points.node_index[point]]];
  }
  std::vector<std::uint32_t> order(weights.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return weights[a] > weights[b]; });
  Islands result;
  for (const std::uint32_t part : order) {
    const bool is_dust =
        weights[part] < dust_fraction * weights[order.front()] || parts.sizes[part] < least_island_nodes;
    if (is_dust) {
      result.dust_points += counts[part];
    } else {
      result.islands.push_back(extract_island(points, parts.component, part));
    }
  }
  return result;
}

}  // namespace spoonbill
