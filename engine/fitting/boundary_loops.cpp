#include "engine/fitting/boundary_loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/fitting/scan.h"

namespace spoonbill {
namespace {

constexpr std::size_t least_loop_nodes = 4;
constexpr std::size_t corner_limit = 500;
constexpr std::size_t cap_triangle_limit = 20'000;
constexpr std::uint32_t no_index = 0xffffffffU;
constexpr double open_angle = 0.62 * std::numbers::pi;

void measure(const PointGraph& graph, BoundaryLoop& loop) {
  for (std::size_t k = 0; k < loop.nodes.size(); ++k) {
    const double step = graph.length(loop.nodes[k], loop.nodes[(k + 1) % loop.nodes.size()]);
    loop.length_m += step;
    loop.centre_m += graph.points_m[loop.nodes[k]];
  }
  loop.centre_m /= static_cast<double>(loop.nodes.size());
}

void sort_longest_first(std::vector<BoundaryLoop>& boundary_loops) {
  std::sort(boundary_loops.begin(), boundary_loops.end(),
            [](const BoundaryLoop& a, const BoundaryLoop& b) { return a.length_m > b.length_m; });
}

void append_ring(std::vector<std::uint32_t> ring, const PointGraph& graph,
                 std::vector<BoundaryLoop>& boundary_loops) {
  if (ring.size() < least_loop_nodes) return;
  BoundaryLoop loop{std::move(ring)};
  measure(graph, loop);
  boundary_loops.push_back(std::move(loop));
}

// Divides a closed path into simple loops and appends them: each time the path returns to a node, the part of
// the path since the last visit to that node is a loop.
void append_simple_loops(const std::vector<std::uint32_t>& path, const PointGraph& graph,
                         std::vector<BoundaryLoop>& boundary_loops) {
  std::vector<std::uint32_t> open;
  std::map<std::uint32_t, std::size_t> index;
  for (const std::uint32_t node : path) {
    const auto seen = index.find(node);
    if (seen == index.end()) {
      index[node] = open.size();
      open.push_back(node);
      continue;
    }
    const auto begin = open.begin() + static_cast<std::ptrdiff_t>(seen->second);
    append_ring({begin, open.end()}, graph, boundary_loops);
    for (auto removed = begin + 1; removed != open.end(); ++removed) index.erase(*removed);
    open.erase(begin + 1, open.end());
  }
  append_ring(std::move(open), graph, boundary_loops);
}

// Returns the widest angle around a node, in radians, that contains none of the nodes within two edges of
// this node. The angle is measured in the plane in which these neighbours spread most. Returns 0 with fewer
// than three neighbours.
double widest_gap(const PointGraph& graph, std::uint32_t node) {
  std::set<std::uint32_t> near;
  for (const std::uint32_t other : graph.adjacent(node)) {
    near.insert(other);
    near.insert(graph.adjacent(other).begin(), graph.adjacent(other).end());
  }
  near.erase(node);
  if (near.size() < 3) return 0.0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3 mean = Vector3::Zero();
  for (const std::uint32_t other : near) mean += graph.points_m[other] / static_cast<double>(near.size());
  for (const std::uint32_t other : near) {
    spread += (graph.points_m[other] - mean) * (graph.points_m[other] - mean).transpose();
  }
  const Eigen::Matrix3d axes = decompose_symmetric(spread).vectors;
  std::vector<double> angles;
  for (const std::uint32_t other : near) {
    const Vector3 path = graph.points_m[other] - graph.points_m[node];
    angles.push_back(std::atan2(path.dot(axes.col(1)), path.dot(axes.col(2))));
  }
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) gap = std::max(gap, angles[k] - angles[k - 1]);
  return gap;
}

// Returns a graph of the given nodes, with edges between nodes that are at most `steps` edges apart in
// `graph`.
PointGraph connect_within(const PointGraph& graph, const std::vector<std::uint32_t>& nodes, int steps) {
  std::vector<std::uint32_t> index(graph.size(), no_index);
  std::vector<Vector3> points;
  for (const std::uint32_t node : nodes) {
    index[node] = static_cast<std::uint32_t>(points.size());
    points.push_back(graph.points_m[node]);
  }
  std::vector<NodePair> pairs;
  for (const std::uint32_t node : nodes) {
    std::set<std::uint32_t> reached{node}, loop{node};
    for (int step = 0; step < steps; ++step) {
      std::set<std::uint32_t> next;
      for (const std::uint32_t other : loop) {
        for (const std::uint32_t further : graph.adjacent(other)) {
          if (reached.insert(further).second) next.insert(further);
        }
      }
      loop = std::move(next);
    }
    for (const std::uint32_t other : reached) {
      if (other != node && index[other] != no_index) pairs.emplace_back(index[node], index[other]);
    }
  }
  return make_point_graph(std::move(points), pairs);
}

// Returns a closed ring through a connected strip of nodes: along a first path from one end of the strip to
// the farthest node, and back along a second path beside it. Returns an empty ring if there is no second
// path.
std::vector<std::uint32_t> find_ring(const PointGraph& part) {
  const auto farthest = [&](const ShortestPaths& paths) {
    return static_cast<std::uint32_t>(std::max_element(paths.length.begin(), paths.length.end()) -
                                      paths.length.begin());
  };
  const std::vector<std::uint32_t> first{0};
  const std::uint32_t a = farthest(shortest_paths(part, first));
  const ShortestPaths paths = shortest_paths(part, std::vector<std::uint32_t>{a});
  const std::uint32_t b = farthest(paths);
  std::vector<std::uint32_t> there{b};
  for (std::uint32_t n = b; n != a;) there.push_back(n = paths.predecessor[n]);
  // The second path must not use the nodes of the first path and their neighbours, except near both ends.
  std::vector<bool> is_taken(part.size(), false);
  const double end_reach = 3.0 * mean_edge_length(part);
  for (const std::uint32_t n : there) {
    if (std::min(part.length(n, a), part.length(n, b)) < end_reach) continue;
    is_taken[n] = true;
    for (const std::uint32_t other : part.adjacent(n)) is_taken[other] = true;
  }
  std::vector<std::uint32_t> remaining;
  std::vector<std::uint32_t> index(part.size(), 0);
  for (std::uint32_t n = 0; n < part.size(); ++n) {
    if (is_taken[n]) continue;
    index[n] = static_cast<std::uint32_t>(remaining.size());
    remaining.push_back(n);
  }
  if (is_taken[a] || is_taken[b]) return {};
  const PointGraph rest = induced_subgraph(part, remaining);
  const ShortestPaths back = shortest_paths(rest, std::vector<std::uint32_t>{index[b]});
  if (!std::isfinite(back.length[index[a]])) return {};
  std::reverse(there.begin(), there.end());  // the path runs from a to b
  std::vector<std::uint32_t> ring = there;
  std::vector<std::uint32_t> rest_path{index[a]};
  for (std::uint32_t n = index[a]; n != index[b];) rest_path.push_back(n = back.predecessor[n]);
  for (std::size_t k = rest_path.size() - 1; k-- > 1;) ring.push_back(remaining[rest_path[k]]);
  return ring;
}

// Triangulates a closed path with the least total area, by dynamic programming over its chords. Long paths
// are subsampled to `corner_limit` corners.
std::vector<TriangleCorners> least_area_triangles(const std::vector<Vector3>& path) {
  const std::size_t stride = (path.size() + corner_limit - 1) / corner_limit;
  std::vector<std::uint32_t> corners;
  for (std::size_t k = 0; k < path.size(); k += stride) corners.push_back(static_cast<std::uint32_t>(k));
  const std::size_t n = corners.size();
  std::vector<float> least(n * n, 0.0F);
  std::vector<std::uint16_t> best(n * n, 0);
  const auto area = [&](std::size_t i, std::size_t k, std::size_t j) {
    const Vector3& a = path[corners[i]];
    return static_cast<float>(0.5 * (path[corners[k]] - a).cross(path[corners[j]] - a).norm());
  };
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      float lowest = std::numeric_limits<float>::infinity();
      for (std::size_t k = i + 1; k < j; ++k) {
        const float sum = least[i * n + k] + least[k * n + j];
        if (sum >= lowest) continue;
        const float whole = sum + area(i, k, j);
        if (whole >= lowest) continue;
        lowest = whole;
        best[i * n + j] = static_cast<std::uint16_t>(k);
      }
      least[i * n + j] = lowest;
    }
  }
  std::vector<TriangleCorners> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> waiting{{0, n - 1}};
  while (!waiting.empty()) {
    const auto [i, j] = waiting.back();
    waiting.pop_back();
    if (j < i + 2) continue;
    const std::size_t k = best[i * n + j];
    triangles.push_back({corners[i], corners[k], corners[j]});
    waiting.emplace_back(i, k);
    waiting.emplace_back(k, j);
  }
  return triangles;
}

// Completes a ring of nodes: between two consecutive nodes without an edge, inserts a common neighbour, if
// they have one. Of several common neighbours, inserts the one that gives the shortest path.
std::vector<std::uint32_t> fill_steps(const PointGraph& graph, const std::vector<std::uint32_t>& ring) {
  std::vector<std::uint32_t> steps;
  std::set<std::uint32_t> is_taken(ring.begin(), ring.end());
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::uint32_t a = ring[k], b = ring[(k + 1) % ring.size()];
    steps.push_back(a);
    const auto near_a = graph.adjacent(a), near_b = graph.adjacent(b);
    if (std::binary_search(near_a.begin(), near_a.end(), b)) continue;
    double shortest = std::numeric_limits<double>::infinity();
    std::uint32_t between = a;
    for (const std::uint32_t node : near_a) {
      const double path = graph.length(a, node) + graph.length(node, b);
      if (path >= shortest || !std::binary_search(near_b.begin(), near_b.end(), node)) continue;
      shortest = path;
      between = node;
    }
    if (is_taken.insert(between).second) steps.push_back(between);
  }
  return steps;
}

}  // namespace

std::vector<BoundaryLoop> find_mesh_boundaries(const std::vector<TriangleCorners>& triangles,
                                               const std::vector<std::uint32_t>& node_index,
                                               const PointGraph& graph) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(node_index.begin(), node_index.end(),
                                     [&](std::uint32_t node) { return node < graph.size(); }));
  // For each directed edge: the number of triangles that use it, minus the number that use it in the opposite
  // direction.
  std::map<NodePair, int> sides;
  for (const TriangleCorners& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = node_index[t[k]], b = node_index[t[(k + 1) % 3]];
      if (a == b) continue;
      ++sides[{a, b}];
      --sides[{b, a}];
    }
  }
  std::multimap<std::uint32_t, std::uint32_t> next;
  for (const auto& [side, count] : sides) {
    if (count == 1) next.emplace(side.first, side.second);
  }
  std::vector<BoundaryLoop> boundary_loops;
  while (!next.empty()) {
    std::vector<std::uint32_t> path{next.begin()->first};
    for (auto step = next.find(path.back()); step != next.end(); step = next.find(path.back())) {
      path.push_back(step->second);
      next.erase(step);
    }
    // The path is reversed, because the triangles of a cap use the edges in the opposite direction.
    std::reverse(path.begin(), path.end());
    append_simple_loops(path, graph, boundary_loops);
  }
  sort_longest_first(boundary_loops);
  return boundary_loops;
}

std::vector<BoundaryLoop> find_cloud_boundaries(const PointGraph& graph) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t node = 0; node < graph.size(); ++node) {
    if (widest_gap(graph, node) > open_angle) open.push_back(node);
  }
  // Numbers of graph steps within which boundary nodes are linked, tried in this order. Noise can hide single
  // boundary nodes, which leaves gaps in a ring; more steps bridge these gaps.
  constexpr std::array steps{2, 4};
  std::vector<BoundaryLoop> boundary_loops;
  if (open.empty()) return boundary_loops;
  const PointGraph all = connect_within(graph, open, steps.front());
  const ConnectedComponents parts = connected_components(all);
  for (std::size_t k = 0; k < parts.sizes.size() && parts.sizes[k] >= 2 * least_loop_nodes; ++k) {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t n = 0; n < all.size(); ++n) {
      if (parts.component[n] == k) nodes.push_back(open[n]);
    }
    std::vector<std::uint32_t> ring;
    for (std::size_t s = 0; s < steps.size() && ring.size() < 2 * least_loop_nodes; ++s) {
      ring = find_ring(connect_within(graph, nodes, steps[s]));
    }
    if (ring.size() < 2 * least_loop_nodes) continue;
    BoundaryLoop loop;
    for (const std::uint32_t n : ring) loop.nodes.push_back(nodes[n]);
    loop.nodes = fill_steps(graph, loop.nodes);
    measure(graph, loop);
    boundary_loops.push_back(std::move(loop));
  }
  sort_longest_first(boundary_loops);
  return boundary_loops;
}

Cap cap_hole(const PointGraph& graph, const BoundaryLoop& loop, std::uint32_t first) {
  // `points` has the nodes of the loop first, then the nodes that are added by splitting edges.
  std::vector<Vector3> points;
  for (const std::uint32_t node : loop.nodes) points.push_back(graph.points_m[node]);
  std::vector<TriangleCorners> triangles = least_area_triangles(points);
  const std::size_t own = points.size();
  split_long_edges(points, triangles, 1.5 * mean_edge_length(graph), cap_triangle_limit);
  Cap cap;
  cap.points_m.assign(points.begin() + static_cast<std::ptrdiff_t>(own), points.end());
  std::vector<Vector3> normals(points.size(), Vector3::Zero());
  const auto node_index = [&](std::uint32_t corner) {
    return corner < own ? loop.nodes[corner] : first + corner - static_cast<std::uint32_t>(own);
  };
  for (const TriangleCorners& t : triangles) {
    const Vector3 twice_area = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    cap.area_m2 += 0.5 * twice_area.norm();
    for (std::size_t k = 0; k < 3; ++k) {
      normals[t[k]] += twice_area;
      cap.pairs.emplace_back(node_index(t[k]), node_index(t[(k + 1) % 3]));
    }
  }
  for (std::size_t k = own; k < points.size(); ++k) cap.normals.push_back(normals[k].normalized());
  return cap;
}

}  // namespace spoonbill
