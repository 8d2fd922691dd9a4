#include "engine/fitting/normal_signs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>

#include "engine/base/assert.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/quantiles.h"

namespace spoonbill {
namespace {

// Two nodes may lie in one place, with opposite normals: enough of them to reach all around.
constexpr std::size_t neighbours_of_a_node = 12;
constexpr double longest_pair = 3.0;  // of the median
constexpr double opposite_cosine = -0.5;
// Off the surface, of the distance between two: more is the thickness of a wall.
constexpr double beside_share = 0.25;
// Of all pairs; and of those the share to either side, which is all to one side where they are a wall.
constexpr double least_flipped_share = 0.003, least_side_share = 0.2;
constexpr double clear_majority = 0.75;

std::vector<NodePair> near_pairs(const std::vector<Vector3>& points_m) {
  const NearestPoints nearest(points_m);
  std::vector<NearestPoints::Found> found;
  std::vector<NodePair> pairs;
  std::vector<double> lengths;
  for (std::uint32_t n = 0; n < points_m.size(); ++n) {
    nearest.nearest(points_m[n], neighbours_of_a_node + 1, found);
    for (const NearestPoints::Found& other : found) {
      if (other.index == n) continue;
      pairs.emplace_back(n, other.index);
      lengths.push_back(other.distance);
    }
  }
  const double longest = longest_pair * median_of(lengths);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= longest) pairs[kept++] = pairs[k];
  }
  pairs.resize(kept);
  return pairs;
}

bool disagree(const Scan& nodes, const std::vector<NodePair>& pairs) {
  double above = 0.0, below = 0.0;
  for (const auto& [a, b] : pairs) {
    const Vector3 &normal_a = nodes.normals[a], &normal_b = nodes.normals[b];
    if (!(normal_a.dot(normal_b) < opposite_cosine)) continue;
    const Vector3 way = nodes.points_m[b] - nodes.points_m[a];
    const double height = 0.5 * way.dot(normal_a - normal_b);
    if (std::abs(height) > beside_share * way.norm()) continue;
    (height > 0.0 ? above : below) += 1.0;
  }
  const double flipped = above + below;
  return flipped > least_flipped_share * static_cast<double>(pairs.size()) &&
         std::min(above, below) > least_side_share * flipped;
}

// The cosine between a normal at one end of a chord and that at the other, mirrored.
double agreement(const Vector3& normal_a, const Vector3& normal_b, const Vector3& chord) {
  const double square = chord.squaredNorm();
  if (!(square > 0.0)) return normal_a.dot(normal_b);
  return normal_a.dot(normal_b - 2.0 / square * normal_b.dot(chord) * chord);
}

// What hangs together, in the order in which it was come to, each node after the one that told it its sign.
class SpanningForest {
 public:
  SpanningForest(const PointGraph& graph, const std::vector<Vector3>& normals)
      : graph_(graph), normals_(normals), seen_(graph.size(), false), turned_(graph.size(), false) {}

  std::vector<bool> turned() {
    for (std::uint32_t start = 0; start < graph_.size(); ++start) {
      if (seen_[start] || normals_[start].isZero()) continue;
      span_from(start);
      if (faces_wrongly()) {
        for (const std::uint32_t node : tree_) turned_[node] = !turned_[node];
      }
    }
    return turned_;
  }

 private:
  void span_from(std::uint32_t start) {
    using Entry = std::tuple<double, std::uint32_t, bool>;  // cost, node, whether it is turned
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    waiting.emplace(0.0, start, false);
    tree_.clear();
    while (!waiting.empty()) {
      const auto [cost, node, is_turned] = waiting.top();
      waiting.pop();
      if (seen_[node]) continue;
      seen_[node] = true;
      turned_[node] = is_turned;
      tree_.push_back(node);
      for (const std::uint32_t other : graph_.of(node)) {
        if (seen_[other] || normals_[other].isZero()) continue;
        const double cosine =
            agreement(normals_[node], normals_[other], graph_.points_m[other] - graph_.points_m[node]);
        waiting.emplace(1.0 - std::abs(cosine), other, is_turned != (cosine < 0.0));
      }
    }
  }

  bool faces_wrongly() const {
    const auto count = static_cast<double>(tree_.size());
    const auto turned = static_cast<double>(
        std::count_if(tree_.begin(), tree_.end(), [&](std::uint32_t node) { return turned_[node]; }));
    if (turned <= (1.0 - clear_majority) * count) return false;
    if (turned >= clear_majority * count) return true;
    Vector3 middle = Vector3::Zero();
    for (const std::uint32_t node : tree_) middle += graph_.points_m[node] / count;
    double outwards = 0.0;
    for (const std::uint32_t node : tree_) {
      const double out = normals_[node].dot(graph_.points_m[node] - middle);
      outwards += turned_[node] ? -out : out;
    }
    return outwards < 0.0;
  }

  const PointGraph& graph_;
  const std::vector<Vector3>& normals_;
  std::vector<bool> seen_, turned_;
  std::vector<std::uint32_t> tree_;
};

}  // namespace

std::vector<bool> turned_to_agree(const std::vector<Vector3>& points_m, const std::vector<Vector3>& normals,
                                  const std::vector<NodePair>& pairs) {
  SPOONBILL_ASSERT(points_m.size() == normals.size());
  const PointGraph graph = make_point_graph(points_m, pairs);
  return SpanningForest(graph, normals).turned();
}

std::vector<bool> normals_to_turn(const Scan& nodes) {
  const std::vector<NodePair> pairs = near_pairs(nodes.points_m);
  if (!disagree(nodes, pairs)) return std::vector<bool>(nodes.points_m.size(), false);
  return turned_to_agree(nodes.points_m, nodes.normals, pairs);
}

}  // namespace spoonbill
