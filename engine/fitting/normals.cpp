#include "engine/fitting/normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

// Number of neighbours of a node. It is large enough to reach all around the node even if nodes coincide in
// pairs with opposite normals.
constexpr std::size_t normal_neighbours = 12;
// Largest distance between two neighbours, relative to the median distance. Pairs that are farther apart are
// ignored.
constexpr double longest_pair = 3.0;
constexpr double opposite_cosine = -0.5;
// Largest height of a neighbour above or below a node's tangent plane, relative to the distance between the
// two nodes, at which both count as being on the same face. A greater height means that the neighbour is on
// the other face of a wall.
constexpr double most_height_fraction = 0.25;
// Two limits above which normals count as inconsistent; both must be exceeded. The first limits the opposite
// pairs, as a fraction of all pairs. There are two kinds of opposite pairs: each node is above the tangent
// plane of the other, or each is below it. The second limits the rarer kind, as a fraction of the opposite
// pairs. At a thin wall, all opposite pairs are of one kind.
constexpr double least_flipped_fraction = 0.003, least_side_fraction = 0.2;
constexpr double clear_majority = 0.75;

std::vector<NodePair> near_pairs(const std::vector<Vector3>& points_m) {
  const NearestPoints nearest(points_m);
  std::vector<NearestPoints::Neighbour> found;
  std::vector<NodePair> pairs;
  std::vector<double> lengths;
  for (std::uint32_t n = 0; n < points_m.size(); ++n) {
    nearest.nearest(points_m[n], normal_neighbours + 1, found);
    for (const NearestPoints::Neighbour& other : found) {
      if (other.index == n) continue;
      pairs.emplace_back(n, other.index);
      lengths.push_back(other.distance);
    }
  }
  const double longest = longest_pair * median(lengths);
  std::size_t remaining = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= longest) pairs[remaining++] = pairs[k];
  }
  pairs.resize(remaining);
  return pairs;
}

bool are_inconsistent(const Scan& nodes, const std::vector<NodePair>& pairs) {
  double above = 0.0, below = 0.0;
  for (const auto& [a, b] : pairs) {
    const Vector3 &normal_a = nodes.normals[a], &normal_b = nodes.normals[b];
    if (!(normal_a.dot(normal_b) < opposite_cosine)) continue;
    const Vector3 offset = nodes.points_m[b] - nodes.points_m[a];
    const double height = 0.5 * offset.dot(normal_a - normal_b);
    if (std::abs(height) > most_height_fraction * offset.norm()) continue;
    (height > 0.0 ? above : below) += 1.0;
  }
  const double flipped = above + below;
  return flipped > least_flipped_fraction * static_cast<double>(pairs.size()) &&
         std::min(above, below) > least_side_fraction * flipped;
}

// Returns the cosine of the angle between the normal at one end of a chord and the mirror image of the normal
// at the other end. The mirror is the plane that bisects the chord.
double agreement(const Vector3& normal_a, const Vector3& normal_b, const Vector3& chord) {
  const double square = chord.squaredNorm();
  if (!(square > 0.0)) return normal_a.dot(normal_b);
  return normal_a.dot(normal_b - 2.0 / square * normal_b.dot(chord) * chord);
}

// Minimum spanning trees of the graph's components. Whether a node's normal is flipped follows from the
// normal of its predecessor in the tree.
class SpanningForest {
 public:
  SpanningForest(const PointGraph& graph, const std::vector<Vector3>& normals)
      : graph_(graph), normals_(normals), seen_(graph.size(), false), flipped_(graph.size(), false) {}

  std::vector<bool> find_flipped() {
    for (std::uint32_t start = 0; start < graph_.size(); ++start) {
      if (seen_[start] || normals_[start].isZero()) continue;
      grow_from(start);
      if (is_inverted()) {
        for (const std::uint32_t node : tree_) flipped_[node] = !flipped_[node];
      }
    }
    return flipped_;
  }

 private:
  void grow_from(std::uint32_t start) {
    // Cost of the edge, node, whether the node's normal is flipped.
    using Entry = std::tuple<double, std::uint32_t, bool>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    waiting.emplace(0.0, start, false);
    tree_.clear();
    while (!waiting.empty()) {
      const auto [cost, node, is_flipped] = waiting.top();
      waiting.pop();
      if (seen_[node]) continue;
      seen_[node] = true;
      flipped_[node] = is_flipped;
      tree_.push_back(node);
      for (const std::uint32_t other : graph_.adjacent(node)) {
        if (seen_[other] || normals_[other].isZero()) continue;
        const double cosine =
            agreement(normals_[node], normals_[other], graph_.points_m[other] - graph_.points_m[node]);
        waiting.emplace(1.0 - std::abs(cosine), other, is_flipped != (cosine < 0.0));
      }
    }
  }

  bool is_inverted() const {
    const auto count = static_cast<double>(tree_.size());
    const auto flipped = static_cast<double>(
        std::count_if(tree_.begin(), tree_.end(), [&](std::uint32_t node) { return flipped_[node]; }));
    if (flipped <= (1.0 - clear_majority) * count) return false;
    if (flipped >= clear_majority * count) return true;
    Vector3 centre = Vector3::Zero();
    for (const std::uint32_t node : tree_) centre += graph_.points_m[node] / count;
    double outwards = 0.0;
    for (const std::uint32_t node : tree_) {
      const double out = normals_[node].dot(graph_.points_m[node] - centre);
      outwards += flipped_[node] ? -out : out;
    }
    return outwards < 0.0;
  }

  const PointGraph& graph_;
  const std::vector<Vector3>& normals_;
  std::vector<bool> seen_, flipped_;
  std::vector<std::uint32_t> tree_;
};

}  // namespace

std::vector<bool> orient_consistently(const std::vector<Vector3>& points_m,
                                      const std::vector<Vector3>& normals,
                                      const std::vector<NodePair>& pairs) {
  SPOONBILL_ASSERT(points_m.size() == normals.size());
  const PointGraph graph = make_point_graph(points_m, pairs);
  return SpanningForest(graph, normals).find_flipped();
}

std::vector<bool> find_inconsistent_normals(const Scan& nodes) {
  const std::vector<NodePair> pairs = near_pairs(nodes.points_m);
  if (!are_inconsistent(nodes, pairs)) return std::vector<bool>(nodes.points_m.size(), false);
  return orient_consistently(nodes.points_m, nodes.normals, pairs);
}

namespace {

// Largest spread of points across a node's plane, relative to their spread along it. A greater spread means
// that the points are at an edge or on two faces.
constexpr double most_thickness = 0.15;
constexpr double most_opposed = 0.2;

// Returns the node and the nodes within two edges of it, sorted by index.
std::vector<std::uint32_t> neighbourhood(const PointGraph& graph, std::uint32_t node) {
  std::vector<std::uint32_t> near{node};
  for (const std::uint32_t other : graph.adjacent(node)) {
    near.push_back(other);
    near.insert(near.end(), graph.adjacent(other).begin(), graph.adjacent(other).end());
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

Vector3 estimate_normal(const PointGraph& graph, std::uint32_t node) {
  const std::vector<std::uint32_t> near = neighbourhood(graph, node);
  Vector3 centre = Vector3::Zero();
  for (const std::uint32_t other : near) centre += graph.points_m[other] / static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::uint32_t other : near) {
    const Vector3 offset = graph.points_m[other] - centre;
    scatter += offset * offset.transpose();
  }
  const SymmetricEigen axes = decompose_symmetric(scatter);
  const Vector3& squares = axes.values;
  const bool is_flat = squares[1] > 0.0 && squares[0] < most_thickness * most_thickness * squares[1];
  return is_flat ? Vector3(axes.vectors.col(0)) : Vector3::Zero();
}

std::vector<NodePair> pairs_between(const PointGraph& graph, const std::vector<Vector3>& normals) {
  std::vector<NodePair> pairs;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    for (const std::uint32_t other : graph.adjacent(n)) {
      if (other > n && !normals[n].isZero() && !normals[other].isZero()) pairs.emplace_back(n, other);
    }
  }
  return pairs;
}

// For each component, the number of points at which the surface normal agrees with the normal of the point's
// node (`along`) or opposes it (`against`).
struct Votes {
  std::vector<double> along, against;

  // Returns the sign for a component's normals, or 0 if the votes are too close.
  double sign(std::uint32_t part) const {
    const double fewer = std::min(along[part], against[part]);
    if (fewer > most_opposed * (along[part] + against[part])) return 0.0;
    return along[part] >= against[part] ? 1.0 : -1.0;
  }
};

}  // namespace

std::vector<Vector3> estimate_normals(const FitPoints& points, const Surface& surface,
                                      const std::vector<Vector2>& uv) {
  std::vector<Vector3> node_normals(points.graph.size());
  for (std::uint32_t n = 0; n < node_normals.size(); ++n) node_normals[n] = estimate_normal(points.graph, n);
  const std::vector<NodePair> pairs = pairs_between(points.graph, node_normals);
  const std::vector<bool> is_flipped = orient_consistently(points.graph.points_m, node_normals, pairs);
  for (std::size_t n = 0; n < node_normals.size(); ++n) {
    if (is_flipped[n]) node_normals[n] = -node_normals[n];
  }
  const ConnectedComponents parts = connected_components(make_point_graph(points.graph.points_m, pairs));
  Votes votes{std::vector<double>(parts.sizes.size(), 0.0), std::vector<double>(parts.sizes.size(), 0.0)};
  for (std::size_t p = 0; p < points.node_index.size(); ++p) {
    const SurfacePoint at = evaluate(surface, uv[p].x(), uv[p].y());
    const double cosine = at.du.cross(at.dv).dot(node_normals[points.node_index[p]]);
    if (cosine > 0.0) votes.along[parts.component[points.node_index[p]]] += 1.0;
    if (cosine < 0.0) votes.against[parts.component[points.node_index[p]]] += 1.0;
  }
  std::vector<Vector3> normals(uv.size(), Vector3::Zero());
  for (std::size_t p = 0; p < points.node_index.size(); ++p) {
    const std::uint32_t node = points.node_index[p];
    normals[p] = votes.sign(parts.component[node]) * node_normals[node];
  }
  return normals;
}

namespace {

constexpr int orientation_samples = 32;
// A sheet counts as flat if |sum of offset . area| over its samples is below this fraction of the sum of
// |offset| |area|. The offset is measured from the centre, and the area is a vector along the normal. The
// hollow side of a flat sheet is not clear. An example is a cap whose height is below a sixtieth of its
// width.
constexpr double flat_cap_fraction = 0.05;
// Fraction of the mean normal's length below which a component of the mean normal counts as zero.
constexpr double upright_fraction = 0.1;

struct SurfaceSamples {
  std::vector<Vector3> points_m, areas;  // points and area vectors of the samples; u varies fastest
};

SurfaceSamples sample_surface(const Surface& surface) {
  SurfaceSamples sampled;
  for (int j = 0; j < orientation_samples; ++j) {
    for (int i = 0; i < orientation_samples; ++i) {
      const SurfacePoint at =
          evaluate(surface, (i + 0.5) / orientation_samples, (j + 0.5) / orientation_samples);
      sampled.points_m.push_back(at.position_m);
      sampled.areas.push_back(at.du.cross(at.dv));
    }
  }
  return sampled;
}

bool faces_down(const std::vector<Vector3>& areas) {
  Vector3 whole = Vector3::Zero();
  for (const Vector3& area : areas) whole += area;
  for (const int axis : {2, 1}) {
    if (std::abs(whole[axis]) > upright_fraction * whole.norm()) return whole[axis] < 0.0;
  }
  return whole[0] < 0.0;
}

}  // namespace

bool is_inside_out(const Surface& surface) {
  const SurfaceSamples sampled = sample_surface(surface);
  // A group is one ring of a tube, or a whole sheet.
  const std::size_t group = surface.u.is_periodic() ? orientation_samples : sampled.points_m.size();
  double outwards = 0.0, whole = 0.0;
  for (std::size_t first = 0; first < sampled.points_m.size(); first += group) {
    Vector3 centre = Vector3::Zero();
    for (std::size_t k = first; k < first + group; ++k) {
      centre += sampled.points_m[k] / static_cast<double>(group);
    }
    for (std::size_t k = first; k < first + group; ++k) {
      const Vector3 offset = sampled.points_m[k] - centre;
      outwards += offset.dot(sampled.areas[k]);
      whole += offset.norm() * sampled.areas[k].norm();
    }
  }
  return std::abs(outwards) > flat_cap_fraction * whole ? outwards < 0.0 : faces_down(sampled.areas);
}

}  // namespace spoonbill
