#include "engine/fitting/bridging.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/opening.h"
#include "engine/fitting/shape_start.h"

namespace spoonbill {
namespace {

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

// Begins the second ring where the ways between the two are shortest.
void turn_to(const PointGraph& graph, const std::vector<std::uint32_t>& a, std::vector<std::uint32_t>& b) {
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

// Straight from ring to ring.
void span_gap(FitPoints& points, const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  double length = 0.0;
  for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
    length += points.graph.length(a[k], b[k]) / nodes_around_bridge;
  }
  const auto rings =
      std::max<std::size_t>(1, static_cast<std::size_t>(length / (2.0 * mean_edge_length(points.graph))));
  const auto begin = static_cast<std::uint32_t>(points.graph.size());
  std::vector<Vector3> places, normals;
  std::vector<NodePair> pairs;
  for (std::size_t ring = 1; ring <= rings; ++ring) {
    const double share = static_cast<double>(ring) / static_cast<double>(rings + 1);
    Vector3 middle = Vector3::Zero();
    for (std::size_t k = 0; k < nodes_around_bridge; ++k) {
      const auto here = begin + static_cast<std::uint32_t>(places.size());
      const std::uint32_t before = ring == 1 ? a[k] : here - static_cast<std::uint32_t>(nodes_around_bridge);
      pairs.emplace_back(here, before);
      pairs.emplace_back(here, begin + static_cast<std::uint32_t>((ring - 1) * nodes_around_bridge +
                                                                  (k + 1) % nodes_around_bridge));
      if (ring == rings) pairs.emplace_back(here, b[k]);
      places.push_back((1.0 - share) * points.graph.points_m[a[k]] + share * points.graph.points_m[b[k]]);
      middle += places.back() / nodes_around_bridge;
    }
    for (std::size_t k = places.size() - nodes_around_bridge; k < places.size(); ++k) {
      normals.push_back((places[k] - middle).normalized());
    }
  }
  add_spanning_nodes(points, places, normals, pairs);
}

// Two openings that face each other are run round in opposite directions.
Result<FitPoints> joined_at(const FitPoints& a, const FitPoints& b, const NearestPair& pair) {
  const Vector3 between = (b.graph.points_m[pair.b] - a.graph.points_m[pair.a]).normalized();
  const Opening open_a = opened_at(a, pair.a, between), open_b = opened_at(b, pair.b, -between);
  if (open_a.rim.empty() || open_b.rim.empty()) {
    return Error{"an island is too small to be bridged; use --islands all or largest"};
  }
  std::vector<std::uint32_t> place_a, place_b, rim_a, rim_b;
  FitPoints both = side_by_side(open_a.island, open_b.island, place_a, place_b);
  for (const std::uint32_t node : open_a.rim) rim_a.push_back(place_a[node]);
  for (const std::uint32_t node : open_b.rim) rim_b.push_back(place_b[node]);
  std::reverse(rim_b.begin(), rim_b.end());
  turn_to(both.graph, rim_a, rim_b);
  span_gap(both, rim_a, rim_b);
  return both;
}

// Whether much of a rim is farther from the other islands than where two ends of one body face each other.
bool leads_elsewhere(const FitPoints& island, const Rim& rim, const NearestPoints& others) {
  constexpr double most_of_diameter = 0.25, most_of_nodes = 1.0 / 3.0;
  const double far = most_of_diameter * rim.length_m / M_PI;
  const auto count = std::count_if(rim.nodes.begin(), rim.nodes.end(), [&](std::uint32_t node) {
    return others.nearest(island.graph.points_m[node]).distance > far;
  });
  return static_cast<double>(count) > most_of_nodes * static_cast<double>(rim.nodes.size());
}

bool is_open_beside_gaps(const std::vector<FitPoints>& islands, std::size_t k) {
  const FitPoints& island = islands[k];
  const ShapeKind kind = kind_of_shape(island);
  if (kind == ShapeKind::closed) return false;
  std::vector<Vector3> nodes;
  for (std::size_t other = 0; other < islands.size(); ++other) {
    const std::vector<Vector3>& from = islands[other].graph.points_m;
    if (other != k) nodes.insert(nodes.end(), from.begin(), from.end());
  }
  const NearestPoints others(nodes);
  const std::ptrdiff_t ends = kind == ShapeKind::tube ? 2 : 1;
  return std::any_of(island.rims.begin(), island.rims.begin() + ends,
                     [&](const Rim& rim) { return leads_elsewhere(island, rim, others); });
}

}  // namespace

std::size_t open_beside_gaps(const std::vector<FitPoints>& islands) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < islands.size(); ++k) count += is_open_beside_gaps(islands, k) ? 1 : 0;
  return count;
}

Result<FitPoints> bridged(std::vector<FitPoints> islands) {
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
    auto joined = joined_at(whole, islands[next], pair);
    if (!joined) return joined;
    whole = std::move(joined).value();
    islands.erase(islands.begin() + static_cast<std::ptrdiff_t>(next));
  }
  return whole;
}

}  // namespace spoonbill
