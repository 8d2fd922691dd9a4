#include "engine/fitting/bridging.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

inline constexpr std::size_t nodes_around_bridge = 24;

// A component with a hole cut into it, at which a bridge begins.
struct Opening {
  FitPoints island;  // the component without the nodes that were cut out
  // Nodes at even steps along the hole's boundary, counterclockwise seen from outside. Their number is
  // nodes_around_bridge, or zero if the component is too small.
  std::vector<std::uint32_t> loop;
};

// Radius of an opening along the surface, as a fraction of the component's size.
constexpr double opening_fraction = 0.12;
constexpr std::size_t least_hole_nodes = 5;

// Unrolls the surface along the shortest paths onto the tangent plane of their source node. Returns the
// position of each node on this plane.
std::vector<Vector2> unroll(const FitPoints& points, const ShortestPaths& paths, const Vector3& facing) {
  const PointGraph& graph = points.graph;
  std::vector<std::uint32_t> order(graph.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return paths.length[a] < paths.length[b]; });
  std::vector<Vector3> new_node(graph.size(), Vector3::Zero()), normal(graph.size(), facing);
  std::vector<Eigen::Quaterniond> back(graph.size(), Eigen::Quaterniond::Identity());
  for (const std::uint32_t n : order) {
    const std::uint32_t before = paths.predecessor[n];
    if (before == n) continue;
    if (!points.node_normals[n].isZero()) normal[n] = points.node_normals[n];
    back[n] = back[before] * rotation_between(normal[n], normal[before]);
    const Vector3 step = back[before] * (graph.points_m[n] - graph.points_m[before]);
    const Vector3 flat = step - step.dot(facing) * facing;
    new_node[n] = new_node[before] + (flat.norm() > 0.0 ? Vector3(step.norm() * flat.normalized()) : flat);
  }
  const Vector3 right = facing.unitOrthogonal(), up = facing.cross(right);
  std::vector<Vector2> flat(graph.size());
  for (std::size_t n = 0; n < flat.size(); ++n) flat[n] = {new_node[n].dot(right), new_node[n].dot(up)};
  return flat;
}

// Returns `nodes_around_bridge` nodes at even steps along the closed path.
std::vector<std::uint32_t> sample_evenly(const PointGraph& graph, const std::vector<std::uint32_t>& ring) {
  std::vector<double> reached{0.0};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    reached.push_back(reached.back() + graph.length(ring[k], ring[(k + 1) % ring.size()]));
  }
  std::vector<std::uint32_t> chosen;
  for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
    const double at = reached.back() * static_cast<double>(k) / nodes_around_bridge;
    const auto above = std::upper_bound(reached.begin(), reached.end(), at) - reached.begin();
    const auto next = static_cast<std::size_t>(above), last = next - 1;
    chosen.push_back(ring[(at - reached[last] < reached[next] - at ? last : next) % ring.size()]);
  }
  return chosen;
}

// Lengths of the steps along a ring. A step counts as longer where the normals turn, so that no step of a
// ring crosses a thin wall from one face to the other.
class RingSteps {
 public:
  RingSteps(const FitPoints& points, double reach) : points_(&points), reach_(reach) {}

  double length(std::uint32_t a, std::uint32_t b) const {
    const double turn = 1.0 - points_->node_normals[a].dot(points_->node_normals[b]);
    return points_->graph.length(a, b) + reach_ * turn;
  }
  double length(const std::vector<std::uint32_t>& ring) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) sum += length(ring[k], ring[(k + 1) % ring.size()]);
    return sum;
  }
  // Reverses parts of the closed path as long as this shortens the path (2-opt, Croes 1958).
  void shorten(std::vector<std::uint32_t>& ring) const {
    constexpr int most_passes = 50;
    bool shorter = true;
    for (int pass = 0; pass < most_passes && shorter; ++pass) {
      shorter = false;
      for (std::size_t i = 0; i + 2 < ring.size(); ++i) {
        for (std::size_t k = i + 2; k < ring.size(); ++k) {
          const std::uint32_t a = ring[i], b = ring[i + 1], c = ring[k], d = ring[(k + 1) % ring.size()];
          if (a == d || length(a, c) + length(b, d) >= length(a, b) + length(c, d) - 1e-12) continue;
          std::reverse(ring.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                       ring.begin() + static_cast<std::ptrdiff_t>(k) + 1);
          shorter = true;
        }
      }
    }
  }

 private:
  const FitPoints* points_;
  double reach_;
};

// Returns the nodes of the ring, sorted by their directions from the ring's centroid on a plane.
std::vector<std::uint32_t> sort_by_angle(const std::vector<std::uint32_t>& ring,
                                         const std::vector<Vector2>& flat) {
  Vector2 centre = Vector2::Zero();
  for (const std::uint32_t n : ring) centre += flat[n] / static_cast<double>(ring.size());
  std::vector<std::uint32_t> ordered = ring;
  const auto turn = [&](std::uint32_t n) {
    return std::atan2(flat[n].y() - centre.y(), flat[n].x() - centre.x());
  };
  std::sort(ordered.begin(), ordered.end(), [&](auto a, auto b) { return turn(a) < turn(b); });
  return ordered;
}

// Sorts the nodes of the ring by angle in each of several planes and returns the shortest of the resulting
// closed paths, because the shortest path crosses itself least.
std::vector<std::uint32_t> order_ring(const FitPoints& points, const std::vector<std::uint32_t>& ring,
                                      const ShortestPaths& paths, double reach, const Vector3& facing,
                                      const Vector3& towards) {
  const RingSteps steps(points, reach);
  std::vector<std::uint32_t> best = sort_by_angle(ring, unroll(points, paths, facing));
  steps.shorten(best);
  for (const Vector3& axis : {facing, towards}) {
    const Vector3 right = axis.unitOrthogonal(), up = axis.cross(right);
    std::vector<Vector2> flat;
    for (const Vector3& point : points.graph.points_m) flat.emplace_back(point.dot(right), point.dot(up));
    std::vector<std::uint32_t> ordered = sort_by_angle(ring, flat);
    steps.shorten(ordered);
    if (steps.length(ordered) < steps.length(best)) best = std::move(ordered);
  }
  return best;
}

// Returns true if the ring runs counterclockwise around the opening, seen from outside the body. Each node
// votes with its normal. Without normals, `towards` is taken as the direction out of the body.
bool runs_counterclockwise(const FitPoints& points, const std::vector<std::uint32_t>& ring,
                           const ShortestPaths& paths, double reach, const Vector3& towards) {
  const PointGraph& graph = points.graph;
  double votes = 0.0;
  Vector3 area = Vector3::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::uint32_t here = ring[k], next = ring[(k + 1) % ring.size()];
    const Vector3 offset = graph.points_m[next] - graph.points_m[ring[(k + ring.size() - 1) % ring.size()]];
    area += (graph.points_m[here] - graph.points_m[ring[0]])
                .cross(graph.points_m[next] - graph.points_m[ring[0]]);
    for (const std::uint32_t other : graph.adjacent(here)) {
      if (paths.length[other] >= reach) continue;
      const Vector3 outwards = graph.points_m[here] - graph.points_m[other];
      votes += offset.cross(points.node_normals[here]).dot(outwards);
    }
  }
  return votes != 0.0 ? votes > 0.0 : area.dot(towards) > 0.0;
}

// Cuts out the nodes whose path from `node` is shorter than opening_fraction of the component's size, and
// assigns their points to the nearest remaining nodes. The loop is the shortest closed path found through the
// boundary nodes; steps count as longer where the normals turn. The search starts from the order of the nodes
// in three planes. The nodes are projected onto two of them; the surface is unrolled along shortest paths
// onto the third (Schmidt, Grimm and Wyvill 2006). Where the boundary runs over the edge of a thin wall,
// every projection folds the boundary onto itself, and only the unrolled surface shows its order. `towards`
// replaces the normal of a component without normals.
Opening cut_opening(const FitPoints& whole, std::uint32_t node, const Vector3& towards) {
  SPOONBILL_ASSERT(node < whole.graph.size());
  const double reach = opening_fraction * bounding_diagonal_m(whole.graph.points_m);
  const ShortestPaths paths = shortest_paths(whole.graph, std::array<std::uint32_t, 1>{node});
  std::vector<std::uint32_t> remaining, ring, new_node(whole.graph.size(), no_point);
  const std::size_t real = whole.graph.size() - whole.spanning_nodes;
  Opening opened{whole, {}};
  opened.island.node_normals.clear();
  opened.island.spanning_nodes = 0;
  for (std::uint32_t n = 0; n < whole.graph.size(); ++n) {
    if (paths.length[n] < reach) continue;
    new_node[n] = static_cast<std::uint32_t>(remaining.size());
    remaining.push_back(n);
    opened.island.node_normals.push_back(whole.node_normals[n]);
    if (n >= real) ++opened.island.spanning_nodes;
    const auto near = whole.graph.adjacent(n);
    if (std::any_of(near.begin(), near.end(), [&](auto m) { return paths.length[m] < reach; })) {
      ring.push_back(n);
    }
  }
  if (ring.size() < least_hole_nodes) return opened;
  const Vector3 facing = whole.node_normals[node].isZero() ? towards : whole.node_normals[node];
  ring = order_ring(whole, ring, paths, reach, facing, towards);
  if (!runs_counterclockwise(whole, ring, paths, reach, towards)) std::reverse(ring.begin(), ring.end());
  opened.loop = sample_evenly(whole.graph, ring);
  for (std::uint32_t& n : opened.loop) n = new_node[n];
  opened.island.graph = induced_subgraph(whole.graph, remaining);
  const NearestPoints nearest(opened.island.graph.points_m);
  for (std::size_t p = 0; p < whole.node_index.size(); ++p) {
    const std::uint32_t to = new_node[whole.node_index[p]];
    opened.island.node_index[p] = to != no_point ? to : nearest.nearest(whole.scan.points_m[p]).index;
  }
  return opened;
}

struct NearestPair {
  std::uint32_t a = 0, b = 0;
  double distance = std::numeric_limits<double>::infinity();
};

NearestPair nearest_pair(const PointGraph& a, const PointGraph& b) {
  const NearestPoints nearest(b.points_m);
  NearestPair pair;
  for (std::uint32_t n = 0; n < a.size(); ++n) {
    const auto found = nearest.nearest(a.points_m[n]);
    if (found.distance < pair.distance) pair = {n, found.index, found.distance};
  }
  return pair;
}

// Combines two components without adding edges between them. Nodes that span holes or gaps get the last
// numbers. `index_a` and `index_b` receive the new number of each node.
FitPoints combine(const FitPoints& a, const FitPoints& b, std::vector<std::uint32_t>& index_a,
                  std::vector<std::uint32_t>& index_b) {
  FitPoints both = a;
  std::vector<Vector3> nodes;
  both.node_normals.clear();
  index_a.assign(a.graph.size(), 0);
  index_b.assign(b.graph.size(), 0);
  const auto put = [&](const FitPoints& from, std::vector<std::uint32_t>& index, bool spanning) {
    const std::size_t real = from.graph.size() - from.spanning_nodes;
    for (std::size_t n = spanning ? real : 0; n < (spanning ? from.graph.size() : real); ++n) {
      index[n] = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(from.graph.points_m[n]);
      both.node_normals.push_back(from.node_normals[n]);
    }
  };
  for (const bool spanning : {false, true}) {
    put(a, index_a, spanning);
    put(b, index_b, spanning);
  }
  std::vector<NodePair> pairs;
  for (const auto& [from, index] : {std::pair(&a, &index_a), std::pair(&b, &index_b)}) {
    for (std::uint32_t n = 0; n < from->graph.size(); ++n) {
      for (const std::uint32_t other : from->graph.adjacent(n))
        pairs.emplace_back((*index)[n], (*index)[other]);
    }
  }
  both.graph = make_point_graph(std::move(nodes), pairs);
  both.spanning_nodes = a.spanning_nodes + b.spanning_nodes;
  for (std::uint32_t& node : both.node_index) node = index_a[node];
  const auto first_point = static_cast<std::uint32_t>(a.scan.points_m.size());
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(both.scan.points_m, b.scan.points_m);
  add(both.scan.normals, b.scan.normals);
  add(both.weights, b.weights);
  add(both.given_m, b.given_m);
  for (const std::uint32_t node : b.node_index) both.node_index.push_back(index_b[node]);
  for (const std::uint32_t point : b.representative) both.representative.push_back(point + first_point);
  both.boundary_loops.clear();
  return both;
}

// Rotates the order of the nodes of ring b so that the sum of their squared distances from the nodes of ring
// a is smallest.
void align_rings(const PointGraph& graph, const std::vector<std::uint32_t>& a,
                 std::vector<std::uint32_t>& b) {
  const auto squares = [&] {
    double sum = 0.0;
    for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
      sum += (graph.points_m[a[k]] - graph.points_m[b[k]]).squaredNorm();
    }
    return sum;
  };
  std::vector<std::uint32_t> best = b;
  double least = squares();
  for (std::size_t turn = 1; turn < nodes_around_bridge; ++turn) {
    std::rotate(b.begin(), b.begin() + 1, b.end());
    if (const double sum = squares(); sum < least) {
      least = sum;
      best = b;
    }
  }
  b = std::move(best);
}

// Adds a straight tube of nodes between ring a and ring b.
void span_gap(FitPoints& points, const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  double length = 0.0;
  for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
    length += points.graph.length(a[k], b[k]) / nodes_around_bridge;
  }
  const auto rings =
      std::max<std::size_t>(1, static_cast<std::size_t>(length / (2.0 * mean_edge_length(points.graph))));
  const auto begin = static_cast<std::uint32_t>(points.graph.size());
  std::vector<Vector3> positions, normals;
  std::vector<NodePair> pairs;
  for (std::size_t ring = 1; ring <= rings; ++ring) {
    const double fraction = static_cast<double>(ring) / static_cast<double>(rings + 1);
    Vector3 centre = Vector3::Zero();
    for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
      const auto here = begin + static_cast<std::uint32_t>(positions.size());
      const std::uint32_t before = ring == 1 ? a[k] : here - static_cast<std::uint32_t>(nodes_around_bridge);
      pairs.emplace_back(here, before);
      pairs.emplace_back(here, begin + static_cast<std::uint32_t>((ring - 1) * nodes_around_bridge +
                                                                  (k + 1) % nodes_around_bridge));
      if (ring == rings) pairs.emplace_back(here, b[k]);
      positions.push_back((1.0 - fraction) * points.graph.points_m[a[k]] +
                          fraction * points.graph.points_m[b[k]]);
      centre += positions.back() / nodes_around_bridge;
    }
    for (std::size_t k = positions.size() - nodes_around_bridge; k < positions.size(); ++k) {
      normals.push_back((positions[k] - centre).normalized());
    }
  }
  add_spanning_nodes(points, positions, normals, pairs);
}

// Joins two components by a tube between two openings, which are cut at the nearest pair of nodes. The loops
// of openings that face each other run in opposite directions, so one loop is reversed.
Result<FitPoints> join_at(const FitPoints& a, const FitPoints& b, const NearestPair& pair) {
  const Vector3 between = (b.graph.points_m[pair.b] - a.graph.points_m[pair.a]).normalized();
  const Opening open_a = cut_opening(a, pair.a, between), open_b = cut_opening(b, pair.b, -between);
  if (open_a.loop.empty() || open_b.loop.empty()) {
    return Error(ErrorCode::too_few, "an island is too small to be bridged; use --islands all or largest",
                 "islands");
  }
  std::vector<std::uint32_t> index_a, index_b, ring_a, ring_b;
  FitPoints both = combine(open_a.island, open_b.island, index_a, index_b);
  for (const std::uint32_t node : open_a.loop) ring_a.push_back(index_a[node]);
  for (const std::uint32_t node : open_b.loop) ring_b.push_back(index_b[node]);
  std::reverse(ring_b.begin(), ring_b.end());
  align_rings(both.graph, ring_a, ring_b);
  span_gap(both, ring_a, ring_b);
  return both;
}

// Returns true if more than a third of a loop's nodes are far from all other components: farther than a
// quarter of the loop's diameter. If two ends face each other across a gap in one body, they are nearer to
// each other than this.
bool is_free_end(const FitPoints& island, const BoundaryLoop& loop, const NearestPoints& others) {
  constexpr double most_distance_ratio = 0.25, most_node_fraction = 1.0 / 3.0;
  const double far = most_distance_ratio * loop.length_m / M_PI;
  const auto count = std::count_if(loop.nodes.begin(), loop.nodes.end(), [&](std::uint32_t node) {
    return others.nearest(island.graph.points_m[node]).distance > far;
  });
  return static_cast<double>(count) > most_node_fraction * static_cast<double>(loop.nodes.size());
}

bool has_free_end(const std::vector<FitPoints>& islands, std::size_t k) {
  const FitPoints& island = islands[k];
  const ShapeKind kind = classify_shape(island);
  if (kind == ShapeKind::closed) return false;
  std::vector<Vector3> nodes;
  for (std::size_t other = 0; other < islands.size(); ++other) {
    const std::vector<Vector3>& from = islands[other].graph.points_m;
    if (other != k) nodes.insert(nodes.end(), from.begin(), from.end());
  }
  const NearestPoints others(nodes);
  const std::ptrdiff_t ends = kind == ShapeKind::tube ? 2 : 1;
  return std::any_of(island.boundary_loops.begin(), island.boundary_loops.begin() + ends,
                     [&](const BoundaryLoop& loop) { return is_free_end(island, loop, others); });
}

}  // namespace

std::size_t count_open_islands(const std::vector<FitPoints>& islands) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < islands.size(); ++k) count += has_free_end(islands, k) ? 1 : 0;
  return count;
}

Result<FitPoints> bridge_islands(std::vector<FitPoints> islands) {
  SPOONBILL_ASSERT(!islands.empty());
  for (FitPoints& island : islands) span_all_holes(island);
  FitPoints whole = std::move(islands.front());
  islands.erase(islands.begin());
  while (!islands.empty()) {
    std::size_t next = 0;
    NearestPair pair;
    for (std::size_t k = 0; k < islands.size(); ++k) {
      const NearestPair found = nearest_pair(whole.graph, islands[k].graph);
      if (found.distance >= pair.distance) continue;
      pair = found;
      next = k;
    }
    auto joined = join_at(whole, islands[next], pair);
    if (!joined) return joined;
    whole = std::move(joined).value();
    islands.erase(islands.begin() + static_cast<std::ptrdiff_t>(next));
  }
  return whole;
}

}  // namespace spoonbill
