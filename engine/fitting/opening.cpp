#include "engine/fitting/opening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "engine/fitting/nearest_points.h"

namespace spoonbill {
namespace {

// The radius of an opening along the surface, of the island's size.
constexpr double opening_share = 0.12;
constexpr std::size_t least_rim = 5;

// Where each node lies in the plane at the source to which the surface is unrolled.
std::vector<Vector2> unrolled(const FitPoints& points, const ShortestWays& ways, const Vector3& facing) {
  const PointGraph& graph = points.graph;
  std::vector<std::uint32_t> order(graph.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return ways.length[a] < ways.length[b]; });
  std::vector<Vector3> place(graph.size(), Vector3::Zero()), normal(graph.size(), facing);
  std::vector<Eigen::Quaterniond> back(graph.size(), Eigen::Quaterniond::Identity());
  for (const std::uint32_t n : order) {
    const std::uint32_t before = ways.before[n];
    if (before == n) continue;
    if (!points.node_normals[n].isZero()) normal[n] = points.node_normals[n];
    back[n] = back[before] * Eigen::Quaterniond::FromTwoVectors(normal[n], normal[before]);
    const Vector3 step = back[before] * (graph.points_m[n] - graph.points_m[before]);
    const Vector3 flat = step - step.dot(facing) * facing;
    place[n] = place[before] + (flat.norm() > 0.0 ? Vector3(step.norm() * flat.normalized()) : flat);
  }
  const Vector3 right = facing.unitOrthogonal(), up = facing.cross(right);
  std::vector<Vector2> flat(graph.size());
  for (std::size_t n = 0; n < flat.size(); ++n) flat[n] = {place[n].dot(right), place[n].dot(up)};
  return flat;
}

// So many nodes, evenly along the closed way through all.
std::vector<std::uint32_t> evenly_along(const PointGraph& graph, const std::vector<std::uint32_t>& ring) {
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

// From node to node of a ring, so that a way from face to face of a thin wall is a long one.
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
  // Turns parts of the closed way round while that shortens it (2-opt, Croes 1958).
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

// The ring in the order of directions from the middle of its places on a plane.
std::vector<std::uint32_t> in_turn(const std::vector<std::uint32_t>& ring, const std::vector<Vector2>& flat) {
  Vector2 middle = Vector2::Zero();
  for (const std::uint32_t n : ring) middle += flat[n] / static_cast<double>(ring.size());
  std::vector<std::uint32_t> ordered = ring;
  const auto turn = [&](std::uint32_t n) {
    return std::atan2(flat[n].y() - middle.y(), flat[n].x() - middle.x());
  };
  std::sort(ordered.begin(), ordered.end(), [&](auto a, auto b) { return turn(a) < turn(b); });
  return ordered;
}

// From the plane on which the closed way through all is shortest: that on which it crosses itself least.
std::vector<std::uint32_t> in_order(const FitPoints& points, const std::vector<std::uint32_t>& ring,
                                    const ShortestWays& ways, double reach, const Vector3& facing,
                                    const Vector3& towards) {
  const RingSteps steps(points, reach);
  std::vector<std::uint32_t> best = in_turn(ring, unrolled(points, ways, facing));
  steps.shorten(best);
  for (const Vector3& axis : {facing, towards}) {
    const Vector3 right = axis.unitOrthogonal(), up = axis.cross(right);
    std::vector<Vector2> flat;
    for (const Vector3& point : points.graph.points_m) flat.emplace_back(point.dot(right), point.dot(up));
    std::vector<std::uint32_t> ordered = in_turn(ring, flat);
    steps.shorten(ordered);
    if (steps.length(ordered) < steps.length(best)) best = std::move(ordered);
  }
  return best;
}

// Whether the ring runs counterclockwise as seen from outside: then what stayed lies to its right. Each of
// its nodes votes by its own normal; without normals the area within does, as seen from `towards`.
bool runs_counterclockwise(const FitPoints& points, const std::vector<std::uint32_t>& ring,
                           const ShortestWays& ways, double reach, const Vector3& towards) {
  const PointGraph& graph = points.graph;
  double votes = 0.0;
  Vector3 area = Vector3::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::uint32_t here = ring[k], next = ring[(k + 1) % ring.size()];
    const Vector3 way = graph.points_m[next] - graph.points_m[ring[(k + ring.size() - 1) % ring.size()]];
    area += (graph.points_m[here] - graph.points_m[ring[0]])
                .cross(graph.points_m[next] - graph.points_m[ring[0]]);
    for (const std::uint32_t other : graph.of(here)) {
      if (ways.length[other] >= reach) continue;
      const Vector3 outwards = graph.points_m[here] - graph.points_m[other];
      votes += way.cross(points.node_normals[here]).dot(outwards);
    }
  }
  return votes != 0.0 ? votes > 0.0 : area.dot(towards) > 0.0;
}

}  // namespace

Opening opened_at(const FitPoints& whole, std::uint32_t node, const Vector3& towards) {
  SPOONBILL_ASSERT(node < whole.graph.size());
  const double reach = opening_share * size_of(whole.graph.points_m);
  const ShortestWays ways = shortest_ways(whole.graph, std::array<std::uint32_t, 1>{node});
  std::vector<std::uint32_t> kept, ring, place(whole.graph.size(), no_point);
  const std::size_t real = whole.graph.size() - whole.spanning_nodes;
  Opening opened{whole, {}};
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
      ring.push_back(n);
    }
  }
  if (ring.size() < least_rim) return opened;
  const Vector3 facing = whole.node_normals[node].isZero() ? towards : whole.node_normals[node];
  ring = in_order(whole, ring, ways, reach, facing, towards);
  if (!runs_counterclockwise(whole, ring, ways, reach, towards)) std::reverse(ring.begin(), ring.end());
  opened.rim = evenly_along(whole.graph, ring);
  for (std::uint32_t& n : opened.rim) n = place[n];
  opened.island.graph = part_of(whole.graph, kept);
  const NearestPoints nearest(opened.island.graph.points_m);
  for (std::size_t p = 0; p < whole.node_of.size(); ++p) {
    const std::uint32_t to = place[whole.node_of[p]];
    opened.island.node_of[p] = to != no_point ? to : nearest.nearest(whole.scan.points_m[p]).index;
  }
  return opened;
}

}  // namespace spoonbill
