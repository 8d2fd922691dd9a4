#include "engine/merging/tube_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"

namespace spoonbill {

namespace {

constexpr int samples_around = 48;

// Of a quarter of a circle by a cubic: 4 (sqrt 2 - 1) / 3.
constexpr double quarter_circle = 0.5522847498307936;

struct RingShape {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
};

// The tube must run along v.
RingShape ring_at(const Surface& tube, double v) {
  const std::vector<double> around = uniform_parameters_without_seam(tube.u, samples_around);
  RingShape ring;
  std::vector<Vector3> points;
  for (const double u : around) {
    points.push_back(position(tube, u, v));
    ring.centre_m += points.back() / samples_around;
  }
  for (const Vector3& point : points) ring.radius_m += (point - ring.centre_m).norm() / samples_around;
  return ring;
}

// Along v, ending at v_end where the side was.
Surface with_end_at_v_end(const Surface& tube, Side side) {
  Surface along = across(side) == Direction::u ? exchanged(tube) : tube;
  return is_start(side) ? reversed(along, Direction::v) : along;
}

Surface turned_back(const Surface& along, Side side) {
  Surface tube = is_start(side) ? reversed(along, Direction::v) : along;
  return across(side) == Direction::u ? exchanged(tube) : tube;
}

// From the tube's ring to the pole; the first control points beside the ring continue the tube's sides.
Result<Surface> cap_of(const Surface& tube, double height_m) {
  const double end = tube.v.domain_end();
  const TubeEnd ring = tube_end(tube, Side::v_end);
  double speed = 0.0;
  for (const double u : uniform_parameters_without_seam(tube.u, samples_around)) {
    speed += evaluate(tube, u, end).dv.norm() / samples_around;
  }
  if (!(speed > 0.0)) return Error{"the tube's sides have no direction at the end to cap; cut a piece off"};
  const bool round = height_m > 0.0;
  if (round && ring.outward.isZero()) {
    return Error{"the tube's sides lead out of its end in no common direction; cap it flat"};
  }
  const double length = (round ? 3.0 * quarter_circle * height_m : ring.radius_m) / speed;
  const auto knots = KnotVector::open(3, {0, 0, 0, 0, length, length, length, length});
  if (!knots) return knots.error();
  const Vector3 pole = ring.centre_m + height_m * ring.outward;
  ControlNet net(tube.net.rows, 4);
  const KnotVector& v = tube.v;
  const int last = v.control_point_count() - 1;
  const double step = v.knots()[static_cast<std::size_t>(last) + v.degree()] - v.knots()[last];
  for (int i = 0; i < net.rows; ++i) {
    const Vector3 rim = tube.net.point(i, last);
    const Vector3 slope = v.degree() * (tube.net.point(i, last) - tube.net.point(i, last - 1)) / step;
    const Vector3 spoke = rim - ring.centre_m;
    const Vector3 level = spoke - spoke.dot(ring.outward) * ring.outward;
    net.set_point(i, 0, rim);
    net.set_point(i, 1, round ? Vector3(rim + length / 3.0 * slope) : Vector3(rim + (pole - rim) / 3.0));
    net.set_point(i, 2, pole + (round ? quarter_circle * level : Vector3(spoke / 3.0)));
    net.set_point(i, 3, pole);
  }
  return make_surface(tube.u, knots.value(), std::move(net));
}

// Spokes are straight, and a flat cap's normal stays the same along each: it folds over where a spoke's
// normal points against the ring's area.
std::optional<Vector3> place_of_fold_in_flat(const Surface& cap) {
  constexpr int spokes_in_piece = 16;
  const double start = cap.v.domain_start();
  std::vector<SurfacePoint> rim;
  Vector3 area = Vector3::Zero();
  for (const double u : nested_parameters(cap.u, spokes_in_piece, 0).parameters) {
    rim.push_back(evaluate(cap, u, start));
    area += rim.back().du.cross(rim.back().dv);
  }
  for (const SurfacePoint& point : rim) {
    if (point.du.cross(point.dv).dot(area) < 0.0) return point.position_m;
  }
  return std::nullopt;
}

Error flat_cap_folds(const Vector3& place_m) {
  return Error{
      "a flat cap folds over at " + position_text(place_m) +
      ", for the middle of the ring does not see its rim there; cut the tube where it is rounder and "
      "cap it there"};
}

}  // namespace

bool is_tube(const Surface& surface) {
  return surface.u.is_periodic() != surface.v.is_periodic();
}

std::pair<Side, Side> tube_sides(const Surface& surface) {
  SPOONBILL_ASSERT(is_tube(surface));
  return surface.u.is_periodic() ? std::pair(Side::v_start, Side::v_end)
                                 : std::pair(Side::u_start, Side::u_end);
}

bool is_pole(const Surface& surface, Side side) {
  return !knots_along(surface, across(side)).is_periodic() && !is_joinable(surface, side);
}

TubeEnd tube_end(const Surface& surface, Side side) {
  const Surface along = with_end_at_v_end(surface, side);
  const double start = along.v.domain_start(), end = along.v.domain_end();
  const RingShape ring = ring_at(along, end);
  if (!is_pole(surface, side)) return {ring.centre_m, ring.radius_m, outward(surface, side)};
  const Vector3 inside = ring_at(along, end - 0.02 * (end - start)).centre_m;
  return {ring.centre_m, 0.0, (ring.centre_m - inside).normalized()};
}

Result<Joined> with_cap(const Surface& surface, Side side, double height_m, const JoinRequest& request) {
  SPOONBILL_ASSERT(height_m >= 0.0);
  if (!is_tube(surface) || !is_joinable(surface, side)) {
    return Error{std::string(side_name(side)) + " is not the open end of a tube; choose one that is"};
  }
  Surface along = with_end_at_v_end(surface, side);
  // Clamped, so that the last control points are the ring and its tangents.
  auto clamped = part_of(along, Direction::v, along.v.domain_start(), along.v.domain_end());
  if (!clamped) return clamped.error();
  auto cap = cap_of(clamped.value(), height_m);
  if (!cap) return cap.error();
  if (height_m == 0.0) {
    if (const auto place_m = place_of_fold_in_flat(cap.value())) return flat_cap_folds(*place_m);
  }
  JoinRequest capping = request;
  capping.shared_parameters = true;
  if (height_m == 0.0) capping.continuity = 0;
  auto joined = join_row({std::move(clamped).value(), std::move(cap).value()}, capping);
  if (!joined) return joined.error();
  joined->surface = turned_back(joined->surface, side);
  return joined;
}

Result<Surface> opened_pole(const Surface& surface, Side side, double wide_enough_m) {
  SPOONBILL_ASSERT(wide_enough_m >= 0.0);
  if (!is_tube(surface) || !is_pole(surface, side)) {
    return Error{std::string(side_name(side)) + " is not the pole of a tube; choose one that is"};
  }
  const Surface along = with_end_at_v_end(surface, side);
  const double start = along.v.domain_start(), end = along.v.domain_end();
  constexpr int steps = 400;
  constexpr double straight = 0.1;
  RingShape last = ring_at(along, end);
  for (int k = 1; k < steps / 2; ++k) {
    const double v = end + (start - end) * k / steps;
    const RingShape ring = ring_at(along, v);
    const double way = (ring.centre_m - last.centre_m).norm();
    const bool is_straight = k > 2 && ring.radius_m - last.radius_m < straight * way;
    if (is_straight || ring.radius_m >= wide_enough_m) {
      auto cut = part_of(along, Direction::v, start, v);
      if (!cut) return cut.error();
      return turned_back(cut.value(), side);
    }
    last = ring;
  }
  return Error{"the tube has no straight sides near its " + std::string(side_name(side)) +
               " to be opened at; cut it there, or let it intersect the other"};
}

std::vector<std::pair<PatchEdge, PatchEdge>> nearest_ends(const std::vector<Surface>& tubes) {
  struct Pair {
    PatchEdge a, b;
    double apart_m;
  };
  // The middle of a flat disc is as near to a ring as its edge is: of those the one that is as wide.
  constexpr double width_share = 0.01;
  std::vector<std::pair<PatchEdge, TubeEnd>> ends;
  for (int p = 0; p < static_cast<int>(tubes.size()); ++p) {
    const auto [first, last] = tube_sides(tubes[p]);
    for (const Side side : {first, last}) ends.push_back({{p, side}, tube_end(tubes[p], side)});
  }
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < ends.size(); ++a) {
    for (std::size_t b = a + 1; b < ends.size(); ++b) {
      if (ends[a].first.patch == ends[b].first.patch) continue;
      const TubeEnd &one = ends[a].second, &other = ends[b].second;
      pairs.push_back(
          {ends[a].first, ends[b].first,
           (one.centre_m - other.centre_m).norm() + width_share * std::abs(one.radius_m - other.radius_m)});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.apart_m < b.apart_m; });
  std::vector<int> group(tubes.size());
  std::iota(group.begin(), group.end(), 0);
  std::vector<PatchEdge> used;
  std::vector<std::pair<PatchEdge, PatchEdge>> chosen;
  for (const Pair& pair : pairs) {
    const bool taken = std::any_of(used.begin(), used.end(),
                                   [&](const PatchEdge& end) { return end == pair.a || end == pair.b; });
    const int from = group[pair.b.patch], to = group[pair.a.patch];
    if (taken || from == to) continue;
    std::replace(group.begin(), group.end(), from, to);
    used.insert(used.end(), {pair.a, pair.b});
    chosen.emplace_back(pair.a, pair.b);
  }
  return chosen;
}

}  // namespace spoonbill
