#include "engine/fitting/bridging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/fitting/nearest_points.h"
#include "engine/fitting/shape_start.h"

namespace spoonbill {
namespace {

// The radius of an opening along the surface, of the island's size, and the nodes around a tube.
constexpr double opening_share = 0.12;
constexpr std::size_t nodes_around = 24;
constexpr std::size_t least_ring = 5;

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

// An island without the nodes around one, and those that were next to them.
struct Opened {
  FitPoints island;
  std::vector<std::uint32_t> ring;
};

// Points of nodes that went belong to the nearest that stayed.
Opened opened_at(const FitPoints& whole, std::uint32_t node) {
  const double reach = opening_share * size_of(whole.graph.points_m);
  const ShortestWays ways = shortest_ways(whole.graph, std::array<std::uint32_t, 1>{node});
  std::vector<std::uint32_t> kept, place(whole.graph.size(), no_point);
  const std::size_t real = whole.graph.size() - whole.spanning_nodes;
  Opened opened{whole, {}};
  opened.island.node_normals.clear();
  opened.island.spanning_nodes = 0;
  for (std::uint32_t n = 0; n < whole.graph.size(); ++n) {
    if (ways.length[n] < reach) continue;
    place[n] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(n);
    opened.island.node_normals.push_back(whole.node_normals[n]);
    if (n >= real) ++opened.island.spanning_nodes;
    const auto near = whole.graph.of(n);
    if (std::any_of(near.begin(), near.end(), [&](auto m) { return ways.length[m] < reach; })) {
      opened.ring.push_back(place[n]);
    }
  }
  if (kept.empty()) return opened;
  opened.island.graph = part_of(whole.graph, kept);
  const NearestPoints nearest(opened.island.graph.points_m);
  for (std::size_t p = 0; p < whole.node_of.size(); ++p) {
    const std::uint32_t to = place[whole.node_of[p]];
    opened.island.node_of[p] = to != no_point ? to : nearest.nearest(whole.scan.points_m[p]).index;
  }
  return opened;
}

// Both in one, without a pair between them; the nodes that span keep to the end. `place_b` gives the second's
// nodes their numbers, `place_a` the first's.
FitPoints side_by_side(const FitPoints& a, const FitPoints& b, std::vector<std::uint32_t>& place_a,
                       std::vector<std::uint32_t>& place_b) {
  FitPoints both = a;
  std::vector<Vector3> nodes;
  both.node_normals.clear();
  place_a.assign(a.graph.size(), 0);
  place_b.assign(b.graph.size(), 0);
  const auto put = [&](const FitPoints& from, std::vector<std::uint32_t>& place, bool spanning) {
    const std::size_t real = from.graph.size() - from.spanning_nodes;
    for (std::size_t n = spanning ? real : 0; n < (spanning ? from.graph.size() : real); ++n) {
      place[n] = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(from.graph.points_m[n]);
      both.node_normals.push_back(from.node_normals[n]);
    }
  };
  for (const bool spanning : {false, true}) {
    put(a, place_a, spanning);
    put(b, place_b, spanning);
  }
  std::vector<NodePair> pairs;
  for (const auto& [from, place] : {std::pair(&a, &place_a), std::pair(&b, &place_b)}) {
    for (std::uint32_t n = 0; n < from->graph.size(); ++n) {
      for (const std::uint32_t other : from->graph.of(n)) pairs.emplace_back((*place)[n], (*place)[other]);
    }
  }
  both.graph = make_point_graph(std::move(nodes), pairs);
  both.spanning_nodes = a.spanning_nodes + b.spanning_nodes;
  for (std::uint32_t& node : both.node_of) node = place_a[node];
  const auto first_point = static_cast<std::uint32_t>(a.scan.points_m.size());
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(both.scan.points_m, b.scan.points_m);
  add(both.scan.normals, b.scan.normals);
  add(both.weights, b.weights);
  add(both.given_m, b.given_m);
  for (const std::uint32_t node : b.node_of) both.node_of.push_back(place_b[node]);
  for (const std::uint32_t point : b.stands_for) both.stands_for.push_back(point + first_point);
  both.rims.clear();
  return both;
}

// The ring's nodes by their angle about an axis, one for each of so many directions.
std::vector<std::uint32_t> around(const PointGraph& graph, const std::vector<std::uint32_t>& ring,
                                  const Vector3& axis, const Vector3& first) {
  Vector3 middle = Vector3::Zero();
  for (const std::uint32_t node : ring) middle += graph.points_m[node] / static_cast<double>(ring.size());
  std::vector<std::uint32_t> chosen(nodes_around, ring.front());
  for (std::size_t k = 0; k < nodes_around; ++k) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / nodes_around;
    const Vector3 direction = std::cos(turn) * first + std::sin(turn) * axis.cross(first);
    double best = -2.0;
    for (const std::uint32_t node : ring) {
      Vector3 way = graph.points_m[node] - middle;
      way -= way.dot(axis) * axis;
      const double along = way.normalized().dot(direction);
      if (along <= best) continue;
      best = along;
      chosen[k] = node;
    }
  }
  return chosen;
}

// Straight from ring to ring.
void span_gap(FitPoints& points, const std::vector<std::uint32_t>& ring_a,
              const std::vector<std::uint32_t>& ring_b, const Vector3& axis) {
  const Vector3 first = axis.unitOrthogonal();
  const auto a = around(points.graph, ring_a, axis, first), b = around(points.graph, ring_b, axis, first);
  double length = 0.0;
  for (std::size_t k = 0; k < nodes_around; ++k) length += points.graph.length(a[k], b[k]) / nodes_around;
  const auto rings =
      std::max<std::size_t>(1, static_cast<std::size_t>(length / (2.0 * mean_edge_length(points.graph))));
  const auto begin = static_cast<std::uint32_t>(points.graph.size());
  std::vector<Vector3> places, normals;
  std::vector<NodePair> pairs;
  for (std::size_t ring = 1; ring <= rings; ++ring) {
    const double share = static_cast<double>(ring) / static_cast<double>(rings + 1);
    for (std::size_t k = 0; k < nodes_around; ++k) {
      const auto here = begin + static_cast<std::uint32_t>(places.size());
      const std::uint32_t before = ring == 1 ? a[k] : here - static_cast<std::uint32_t>(nodes_around);
      pairs.emplace_back(here, before);
      pairs.emplace_back(
          here, begin + static_cast<std::uint32_t>((ring - 1) * nodes_around + (k + 1) % nodes_around));
      if (ring == rings) pairs.emplace_back(here, b[k]);
      places.push_back((1.0 - share) * points.graph.points_m[a[k]] + share * points.graph.points_m[b[k]]);
      const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / nodes_around;
      normals.push_back(std::cos(turn) * first + std::sin(turn) * axis.cross(first));
    }
  }
  add_spanning_nodes(points, places, normals, pairs);
}

Result<FitPoints> joined_at(const FitPoints& a, const FitPoints& b, const NearestPair& pair) {
  const Vector3 axis = (b.graph.points_m[pair.b] - a.graph.points_m[pair.a]).normalized();
  const Opened open_a = opened_at(a, pair.a), open_b = opened_at(b, pair.b);
  if (open_a.ring.size() < least_ring || open_b.ring.size() < least_ring) {
    return Error{"an island is too small to be bridged; use --islands all or largest"};
  }
  std::vector<std::uint32_t> place_a, place_b, ring_a, ring_b;
  FitPoints both = side_by_side(open_a.island, open_b.island, place_a, place_b);
  for (const std::uint32_t node : open_a.ring) ring_a.push_back(place_a[node]);
  for (const std::uint32_t node : open_b.ring) ring_b.push_back(place_b[node]);
  span_gap(both, ring_a, ring_b, axis);
  return both;
}

}  // namespace

Result<FitPoints> bridged(std::vector<FitPoints> islands) {
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
    auto joined = joined_at(whole, islands[next], pair);
    if (!joined) return joined;
    whole = std::move(joined).value();
    islands.erase(islands.begin() + static_cast<std::ptrdiff_t>(next));
  }
  return whole;
}

}  // namespace spoonbill
