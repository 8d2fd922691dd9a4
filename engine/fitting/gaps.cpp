#include "engine/fitting/gaps.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/fitting/islands.h"
#include "engine/fitting/quantiles.h"

namespace spoonbill {
namespace {

// Of the median length of a pair: beyond nodes that are next to each other, along an axis or across.
constexpr double doubtful_length = 1.5;
// Of the widest step that leads from point to point of a node: random points leave no wider ones out.
constexpr double gap_steps = 3.0;
// Of the way across a gap, as much at least along the normal of either side: within 45 degrees.
constexpr double facing_share = 0.7;
constexpr std::size_t least_around = 5;
// Fewer points do not tell how far apart they lie.
constexpr std::size_t least_points = 3;
// More are told by some of them.
constexpr std::size_t most_points = 64;

// The direction in which a node and its neighbours spread least; zero where there are too few.
Vector3 normal_at(const PointGraph& graph, std::uint32_t node) {
  const auto around = graph.of(node);
  if (around.size() < least_around) return Vector3::Zero();
  Vector3 middle = graph.points_m[node];
  for (const std::uint32_t near : around) middle += graph.points_m[near];
  middle /= static_cast<double>(around.size() + 1);
  const Vector3 own = graph.points_m[node] - middle;
  Eigen::Matrix3d scatter = own * own.transpose();
  for (const std::uint32_t near : around) {
    const Vector3 way = graph.points_m[near] - middle;
    scatter += way * way.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

bool faces_both(const PointGraph& graph, const NodePair& pair) {
  const Vector3 way = (graph.points_m[pair.second] - graph.points_m[pair.first]).stableNormalized();
  return std::abs(way.dot(normal_at(graph, pair.first))) > facing_share &&
         std::abs(way.dot(normal_at(graph, pair.second))) > facing_share;
}

class NodePoints {
 public:
  NodePoints(const std::vector<Vector3>& points_m, const VoxelGroups& groups) : points_(groups.count) {
    for (std::size_t p = 0; p < points_m.size(); ++p) points_[groups.group_of[p]].push_back(points_m[p]);
    for (std::vector<Vector3>& points : points_) {
      if (points.size() <= most_points) continue;
      const std::size_t stride = 1 + points.size() / most_points;
      for (std::size_t k = 0; k * stride < points.size(); ++k) points[k] = points[k * stride];
      points.resize(1 + (points.size() - 1) / stride);
    }
  }

  bool bridges_gap(const NodePair& pair) const {
    const std::vector<Vector3>&first = points_[pair.first], &second = points_[pair.second];
    if (first.size() < least_points || second.size() < least_points) return false;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3& a : first) {
      for (const Vector3& b : second) nearest = std::min(nearest, (a - b).norm());
    }
    return nearest > gap_steps * std::max(widest_step(first), widest_step(second));
  }

 private:
  // The longest side of the shortest tree over them (Prim 1957).
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

std::vector<double> lengths_of(const std::vector<Vector3>& nodes_m, const std::vector<NodePair>& pairs) {
  std::vector<double> lengths;
  lengths.reserve(pairs.size());
  for (const auto& [a, b] : pairs) lengths.push_back((nodes_m[a] - nodes_m[b]).norm());
  return lengths;
}

// The body that each part is of: itself, or of dust the one that it is paired with nearest by; no_point where
// it is paired with none.
std::vector<std::uint32_t> bodies_of(const GraphParts& parts, const std::vector<std::size_t>& points_of_part,
                                     const std::vector<NodePair>& pairs, const std::vector<double>& lengths) {
  const std::size_t most = *std::max_element(points_of_part.begin(), points_of_part.end());
  std::vector<std::uint32_t> body(parts.sizes.size());
  std::vector<double> nearest(parts.sizes.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> is_dust(parts.sizes.size());
  for (std::uint32_t part = 0; part < body.size(); ++part) {
    is_dust[part] = parts.sizes[part] < least_island_nodes ||
                    static_cast<double>(points_of_part[part]) < dust_share * static_cast<double>(most);
    body[part] = is_dust[part] ? no_point : part;
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::uint32_t a = parts.part_of[pairs[k].first], b = parts.part_of[pairs[k].second];
    for (const auto& [dust, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (!is_dust[dust] || is_dust[other] || !(lengths[k] < nearest[dust])) continue;
      nearest[dust] = lengths[k];
      body[dust] = other;
    }
  }
  return body;
}

}  // namespace

std::vector<NodePair> without_gaps(const std::vector<Vector3>& points_m, const VoxelGroups& groups,
                                   const std::vector<Vector3>& nodes_m, std::vector<NodePair> pairs) {
  SPOONBILL_ASSERT(groups.group_of.size() == points_m.size() && groups.count == nodes_m.size());
  if (pairs.empty()) return pairs;
  const std::vector<double> lengths = lengths_of(nodes_m, pairs);
  const double doubtful = doubtful_length * median_of(lengths);
  std::vector<NodePair> firm;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= doubtful) firm.push_back(pairs[k]);
  }
  const PointGraph near_graph = make_point_graph(nodes_m, firm);
  const GraphParts near_parts = connected_parts(near_graph);
  if (near_parts.sizes.size() == 1) return pairs;
  const NodePoints points(points_m, groups);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto& [a, b] = pairs[k];
    if (near_parts.part_of[a] == near_parts.part_of[b]) continue;
    if (!faces_both(near_graph, pairs[k]) || !points.bridges_gap(pairs[k])) firm.push_back(pairs[k]);
  }
  const GraphParts parts = connected_parts(make_point_graph(nodes_m, firm));
  std::vector<std::size_t> points_of_part(parts.sizes.size(), 0);
  for (const std::uint32_t node : groups.group_of) ++points_of_part[parts.part_of[node]];
  const std::vector<std::uint32_t> body = bodies_of(parts, points_of_part, pairs, lengths);
  std::erase_if(pairs, [&](const NodePair& pair) {
    const std::uint32_t first = body[parts.part_of[pair.first]], second = body[parts.part_of[pair.second]];
    return first != second && first != no_point && second != no_point;
  });
  return pairs;
}

}  // namespace spoonbill
