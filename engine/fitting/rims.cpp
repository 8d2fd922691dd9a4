#include "engine/fitting/rims.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "engine/base/assert.h"
#include "engine/fitting/side_cutting.h"

namespace spoonbill {
namespace {

constexpr std::size_t least_rim = 4;
constexpr std::size_t corner_limit = 500;
constexpr std::size_t cap_triangle_limit = 20'000;
constexpr std::uint32_t no_place = 0xffffffffU;
constexpr double open_angle = 0.62 * std::numbers::pi;

void measure(const PointGraph& graph, Rim& rim) {
  for (std::size_t k = 0; k < rim.nodes.size(); ++k) {
    const double step = graph.length(rim.nodes[k], rim.nodes[(k + 1) % rim.nodes.size()]);
    rim.length_m += step;
    rim.centre_m += graph.points_m[rim.nodes[k]];
  }
  rim.centre_m /= static_cast<double>(rim.nodes.size());
}

void longest_first(std::vector<Rim>& rims) {
  std::sort(rims.begin(), rims.end(), [](const Rim& a, const Rim& b) { return a.length_m > b.length_m; });
}

void append_ring(std::vector<std::uint32_t> ring, const PointGraph& graph, std::vector<Rim>& rims) {
  if (ring.size() < least_rim) return;
  Rim rim{std::move(ring)};
  measure(graph, rim);
  rims.push_back(std::move(rim));
}

// The rings of a way that may come to a node more than once: each time what lies between is a ring.
void append_simple(const std::vector<std::uint32_t>& way, const PointGraph& graph, std::vector<Rim>& rims) {
  std::vector<std::uint32_t> open;
  std::map<std::uint32_t, std::size_t> place;
  for (const std::uint32_t node : way) {
    const auto seen = place.find(node);
    if (seen == place.end()) {
      place[node] = open.size();
      open.push_back(node);
      continue;
    }
    const auto begin = open.begin() + static_cast<std::ptrdiff_t>(seen->second);
    append_ring({begin, open.end()}, graph, rims);
    for (auto gone = begin + 1; gone != open.end(); ++gone) place.erase(*gone);
    open.erase(begin + 1, open.end());
  }
  append_ring(std::move(open), graph, rims);
}

// The widest angle around a node that holds none of its neighbours, in the plane in which they spread.
double widest_gap(const PointGraph& graph, std::uint32_t node) {
  std::set<std::uint32_t> near;
  for (const std::uint32_t other : graph.of(node)) {
    near.insert(other);
    near.insert(graph.of(other).begin(), graph.of(other).end());
  }
  near.erase(node);
  if (near.size() < 3) return 0.0;  // too little to say
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3 mean = Vector3::Zero();
  for (const std::uint32_t other : near) mean += graph.points_m[other] / static_cast<double>(near.size());
  for (const std::uint32_t other : near) {
    spread += (graph.points_m[other] - mean) * (graph.points_m[other] - mean).transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  std::vector<double> angles;
  for (const std::uint32_t other : near) {
    const Vector3 way = graph.points_m[other] - graph.points_m[node];
    angles.push_back(std::atan2(way.dot(axes.col(1)), way.dot(axes.col(2))));
  }
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) gap = std::max(gap, angles[k] - angles[k - 1]);
  return gap;
}

// The nodes given, each with those that are no more than so many steps away.
PointGraph strung_together(const PointGraph& graph, const std::vector<std::uint32_t>& nodes, int steps) {
  std::vector<std::uint32_t> place(graph.size(), no_place);
  std::vector<Vector3> points;
  for (const std::uint32_t node : nodes) {
    place[node] = static_cast<std::uint32_t>(points.size());
    points.push_back(graph.points_m[node]);
  }
  std::vector<NodePair> pairs;
  for (const std::uint32_t node : nodes) {
    std::set<std::uint32_t> reached{node}, rim{node};
    for (int step = 0; step < steps; ++step) {
      std::set<std::uint32_t> next;
      for (const std::uint32_t other : rim) {
        for (const std::uint32_t further : graph.of(other)) {
          if (reached.insert(further).second) next.insert(further);
        }
      }
      rim = std::move(next);
    }
    for (const std::uint32_t other : reached) {
      if (other != node && place[other] != no_place) pairs.emplace_back(place[node], place[other]);
    }
  }
  return make_point_graph(std::move(points), pairs);
}

// The ring through nodes that hang together: from one to the farthest of them and back on the other side.
std::vector<std::uint32_t> ring_through(const PointGraph& part) {
  const auto farthest = [&](const ShortestWays& ways) {
    return static_cast<std::uint32_t>(std::max_element(ways.length.begin(), ways.length.end()) -
                                      ways.length.begin());
  };
  const std::vector<std::uint32_t> first{0};
  const std::uint32_t a = farthest(shortest_ways(part, first));
  const ShortestWays ways = shortest_ways(part, std::vector<std::uint32_t>{a});
  const std::uint32_t b = farthest(ways);
  std::vector<std::uint32_t> there{b};
  for (std::uint32_t n = b; n != a;) there.push_back(n = ways.before[n]);
  // What is near the way there is closed for the way back, but for its ends.
  std::vector<bool> taken(part.size(), false);
  const double end_reach = 3.0 * mean_edge_length(part);
  for (const std::uint32_t n : there) {
    if (std::min(part.length(n, a), part.length(n, b)) < end_reach) continue;
    taken[n] = true;
    for (const std::uint32_t other : part.of(n)) taken[other] = true;
  }
  std::vector<std::uint32_t> left;
  std::vector<std::uint32_t> place(part.size(), 0);
  for (std::uint32_t n = 0; n < part.size(); ++n) {
    if (taken[n]) continue;
    place[n] = static_cast<std::uint32_t>(left.size());
    left.push_back(n);
  }
  if (taken[a] || taken[b]) return {};
  const PointGraph rest = part_of(part, left);
  const ShortestWays back = shortest_ways(rest, std::vector<std::uint32_t>{place[b]});
  if (!std::isfinite(back.length[place[a]])) return {};
  std::reverse(there.begin(), there.end());  // a .. b
  std::vector<std::uint32_t> ring = there;
  std::vector<std::uint32_t> rest_way{place[a]};
  for (std::uint32_t n = place[a]; n != place[b];) rest_way.push_back(n = back.before[n]);
  for (std::size_t k = rest_way.size() - 1; k-- > 1;) ring.push_back(left[rest_way[k]]);
  return ring;
}

// The triangles of a closed way that have the least area together, by dynamic programming over its chords: of
// every so many of its corners where it has too many.
std::vector<TriangleCorners> least_area_triangles(const std::vector<Vector3>& way) {
  const std::size_t stride = (way.size() + corner_limit - 1) / corner_limit;
  std::vector<std::uint32_t> corners;
  for (std::size_t k = 0; k < way.size(); k += stride) corners.push_back(static_cast<std::uint32_t>(k));
  const std::size_t n = corners.size();
  std::vector<float> least(n * n, 0.0F);
  std::vector<std::uint16_t> best(n * n, 0);
  const auto area = [&](std::size_t i, std::size_t k, std::size_t j) {
    const Vector3& a = way[corners[i]];
    return static_cast<float>(0.5 * (way[corners[k]] - a).cross(way[corners[j]] - a).norm());
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

// With the node between two that are two steps apart.
std::vector<std::uint32_t> step_by_step(const PointGraph& graph, const std::vector<std::uint32_t>& ring) {
  std::vector<std::uint32_t> steps;
  std::set<std::uint32_t> taken(ring.begin(), ring.end());
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::uint32_t a = ring[k], b = ring[(k + 1) % ring.size()];
    steps.push_back(a);
    const auto near_a = graph.of(a), near_b = graph.of(b);
    if (std::binary_search(near_a.begin(), near_a.end(), b)) continue;
    double shortest = std::numeric_limits<double>::infinity();
    std::uint32_t between = a;
    for (const std::uint32_t node : near_a) {
      const double way = graph.length(a, node) + graph.length(node, b);
      if (way >= shortest || !std::binary_search(near_b.begin(), near_b.end(), node)) continue;
      shortest = way;
      between = node;
    }
    if (taken.insert(between).second) steps.push_back(between);
  }
  return steps;
}

}  // namespace

std::vector<Rim> rims_of_mesh(const std::vector<TriangleCorners>& triangles,
                              const std::vector<std::uint32_t>& node_of, const PointGraph& graph) {
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(node_of.begin(), node_of.end(), [&](std::uint32_t node) { return node < graph.size(); }));
  std::map<NodePair, int> sides;  // from, to: how many more triangles have it this way round
  for (const TriangleCorners& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = node_of[t[k]], b = node_of[t[(k + 1) % 3]];
      if (a == b) continue;
      ++sides[{a, b}];
      --sides[{b, a}];
    }
  }
  std::multimap<std::uint32_t, std::uint32_t> next;
  for (const auto& [side, count] : sides) {
    if (count == 1) next.emplace(side.first, side.second);
  }
  std::vector<Rim> rims;
  while (!next.empty()) {
    std::vector<std::uint32_t> way{next.begin()->first};
    for (auto step = next.find(way.back()); step != next.end(); step = next.find(way.back())) {
      way.push_back(step->second);
      next.erase(step);
    }
    // The triangles over the hole see its sides the other way round.
    std::reverse(way.begin(), way.end());
    append_simple(way, graph, rims);
  }
  longest_first(rims);
  return rims;
}

std::vector<Rim> rims_of_cloud(const PointGraph& graph) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t node = 0; node < graph.size(); ++node) {
    if (widest_gap(graph, node) > open_angle) open.push_back(node);
  }
  // Noise hides a node here and there: where what is open does not come round, wider steps may.
  constexpr std::array steps{2, 4};
  std::vector<Rim> rims;
  if (open.empty()) return rims;
  const PointGraph all = strung_together(graph, open, steps.front());
  const GraphParts parts = connected_parts(all);
  for (std::size_t k = 0; k < parts.sizes.size() && parts.sizes[k] >= 2 * least_rim; ++k) {
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t n = 0; n < all.size(); ++n) {
      if (parts.part_of[n] == k) nodes.push_back(open[n]);
    }
    std::vector<std::uint32_t> ring;
    for (std::size_t s = 0; s < steps.size() && ring.size() < 2 * least_rim; ++s) {
      ring = ring_through(strung_together(graph, nodes, steps[s]));
    }
    if (ring.size() < 2 * least_rim) continue;
    Rim rim;
    for (const std::uint32_t n : ring) rim.nodes.push_back(nodes[n]);
    rim.nodes = step_by_step(graph, rim.nodes);
    measure(graph, rim);
    rims.push_back(std::move(rim));
  }
  longest_first(rims);
  return rims;
}

Cap cap_over(const PointGraph& graph, const Rim& rim, std::uint32_t first) {
  // The rim's own nodes come first, then those that cutting adds.
  std::vector<Vector3> points;
  for (const std::uint32_t node : rim.nodes) points.push_back(graph.points_m[node]);
  std::vector<TriangleCorners> triangles = least_area_triangles(points);
  const std::size_t own = points.size();
  cut_long_sides(points, triangles, 1.5 * mean_edge_length(graph), cap_triangle_limit);
  Cap cap;
  cap.points_m.assign(points.begin() + static_cast<std::ptrdiff_t>(own), points.end());
  std::vector<Vector3> normals(points.size(), Vector3::Zero());
  const auto node_of = [&](std::uint32_t corner) {
    return corner < own ? rim.nodes[corner] : first + corner - static_cast<std::uint32_t>(own);
  };
  for (const TriangleCorners& t : triangles) {
    const Vector3 twice_area = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    cap.area_m2 += 0.5 * twice_area.norm();
    for (std::size_t k = 0; k < 3; ++k) {
      normals[t[k]] += twice_area;
      cap.pairs.emplace_back(node_of(t[k]), node_of(t[(k + 1) % 3]));
    }
  }
  for (std::size_t k = own; k < points.size(); ++k) cap.normals.push_back(normals[k].normalized());
  return cap;
}

}  // namespace spoonbill
