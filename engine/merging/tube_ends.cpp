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
#include "engine/merging/arrangement.h"

namespace spoonbill {
namespace {

constexpr int largest_count = 200;

double edge_gap_m(const Surface& surface, Direction direction) {
  const bool u = direction == Direction::u;
  const EdgeCurve first = edge_curve(surface, u ? Side::u_start : Side::v_start);
  const EdgeCurve last = edge_curve(surface, u ? Side::u_end : Side::v_end);
  double largest = 0.0;
  for (std::size_t k = 0; k < first.control_points_m.size(); ++k) {
    largest = std::max(largest, (first.control_points_m[k] - last.control_points_m[k]).norm());
  }
  return largest;
}

Result<KnotVector> make_period(const KnotVector& knots, int continuity) {
  const auto all = knot_multiplicities(knots);
  const int at_seam = std::max(1, knots.degree() - continuity);
  std::vector<double> period(static_cast<std::size_t>(at_seam), knots.domain_start());
  for (const auto& [knot, multiplicity] : all) {
    if (knot == knots.domain_start()) continue;
    period.insert(period.end(), static_cast<std::size_t>(multiplicity), knot);
  }
  // A period needs at least two control points.
  if (period.size() < 2) period.push_back(0.5 * (knots.domain_start() + knots.domain_end()));
  period.push_back(knots.domain_end());
  return KnotVector::periodic(knots.degree(), std::move(period));
}

}  // namespace

Result<Approximation> close_around(const Surface& surface, Direction direction, int continuity,
                                   double tolerance_m, const Progress& progress) {
  SPOONBILL_ASSERT(continuity >= 0);
  const KnotVector& knots = knots_along(surface, direction);
  if (knots.is_periodic())
    return Error(ErrorCode::inconsistent, "the direction is closed already; choose the other one");
  if (const double gap_m = edge_gap_m(surface, direction); gap_m > tolerance_m) {
    return Error(ErrorCode::mismatch, "the first and the last edge are " + short_length_text(gap_m) +
                                          " apart; allow a larger tolerance or bring them together");
  }
  const auto raised = elevate_degree(knots, std::max(knots.degree(), continuity + 1));
  if (!raised) return raised.error();
  const auto period = make_period(raised.value(), continuity);
  if (!period) return period.error();
  return approximated(surface, direction, period.value(), tolerance_m, largest_count, progress);
}

namespace {

constexpr int rim_samples = 48;

// Distance of the inner control points of a cubic quarter circle from its ends, relative to its radius: 4
// (sqrt 2 - 1) / 3.
constexpr double quarter_circle = 0.5522847498307936;

struct RingSize {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
};

// Returns the centre and mean radius of the ring at v. The axis of `tube` must be along v.
RingSize ring_at(const Surface& tube, double v) {
  const std::vector<double> parameters = uniform_parameters_without_seam(tube.u, rim_samples);
  RingSize ring;
  std::vector<Vector3> points;
  for (const double u : parameters) {
    points.push_back(position(tube, u, v));
    ring.centre_m += points.back() / rim_samples;
  }
  for (const Vector3& point : points) ring.radius_m += (point - ring.centre_m).norm() / rim_samples;
  return ring;
}

// Returns the tube with its axis along v and the given side at the end of v.
Surface with_end_at_v_end(const Surface& tube, Side side) {
  Surface along = across(side) == Direction::u ? exchanged(tube) : tube;
  return is_start(side) ? reversed(along, Direction::v) : along;
}

Surface turn_back(const Surface& along, Side side) {
  Surface tube = is_start(side) ? reversed(along, Direction::v) : along;
  return across(side) == Direction::u ? exchanged(tube) : tube;
}

// Returns the cap from the end ring of the tube to the pole. In a round cap, the control points next to the
// ring continue the sides of the tube. In a flat cap, they are on straight lines from the ring to the pole.
Result<Surface> make_cap(const Surface& tube, double height_m) {
  const double end = tube.v.domain_end();
  const TubeEnd ring = tube_end(tube, Side::v_end);
  double speed = 0.0;
  for (const double u : uniform_parameters_without_seam(tube.u, rim_samples)) {
    speed += evaluate(tube, u, end).dv.norm() / rim_samples;
  }
  if (!(speed > 0.0))
    return Error(ErrorCode::degenerate,
                 "the tube's tangents along its sides are zero at the end to cap; cut a piece off there");
  const bool round = height_m > 0.0;
  if (round && ring.outward.isZero()) {
    return Error(
        ErrorCode::degenerate,
        "the directions of the tube's sides at its end cancel out, so a round cap has no axis; cap it flat");
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
    const Vector3 ring_point = tube.net.point(i, last);
    const Vector3 slope = v.degree() * (tube.net.point(i, last) - tube.net.point(i, last - 1)) / step;
    const Vector3 spoke = ring_point - ring.centre_m;
    const Vector3 level = spoke - spoke.dot(ring.outward) * ring.outward;
    net.set_point(i, 0, ring_point);
    net.set_point(
        i, 1,
        round ? Vector3(ring_point + length / 3.0 * slope) : Vector3(ring_point + (pole - ring_point) / 3.0));
    net.set_point(i, 2, pole + (round ? quarter_circle * level : Vector3(spoke / 3.0)));
    net.set_point(i, 3, pole);
  }
  return make_surface(tube.u, knots.value(), std::move(net));
}

// Returns a position on the ring at which a flat cap folds. Each spoke of the cap is straight and has a
// constant normal. The cap therefore folds where the normal of a spoke opposes the ring's area vector.
std::optional<Vector3> find_fold_in_flat(const Surface& cap) {
  constexpr int spokes_in_piece = 16;
  const double start = cap.v.domain_start();
  std::vector<SurfacePoint> ring_point;
  Vector3 area = Vector3::Zero();
  for (const double u : nested_parameters(cap.u, spokes_in_piece, 0).parameters) {
    ring_point.push_back(evaluate(cap, u, start));
    area += ring_point.back().du.cross(ring_point.back().dv);
  }
  for (const SurfacePoint& point : ring_point) {
    if (point.du.cross(point.dv).dot(area) < 0.0) return point.position_m;
  }
  return std::nullopt;
}

Error flat_cap_folds(const Vector3& fold_m) {
  return Error(ErrorCode::self_intersecting,
               "a flat cap folds over at " + position_text(fold_m) +
                   ", as the ring is not visible from its centre there; cut the tube where it is rounder and "
                   "cap it there");
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
  const RingSize ring = ring_at(along, end);
  if (!is_pole(surface, side)) return {ring.centre_m, ring.radius_m, outward(surface, side)};
  const Vector3 inside = ring_at(along, end - 0.02 * (end - start)).centre_m;
  return {ring.centre_m, 0.0, (ring.centre_m - inside).normalized()};
}

Result<Joined> add_cap(const Surface& surface, Side side, double height_m, const JoinRequest& request) {
  SPOONBILL_ASSERT(height_m >= 0.0);
  if (!is_tube(surface) || !is_joinable(surface, side)) {
    return Error(ErrorCode::mismatch,
                 std::string(side_name(side)) + " is not the open end of a tube; choose one that is");
  }
  Surface along = with_end_at_v_end(surface, side);
  // The knots are made clamped, so that the last control points give the ring and its tangents.
  auto clamped = part_of(along, Direction::v, along.v.domain_start(), along.v.domain_end());
  if (!clamped) return clamped.error();
  auto cap = make_cap(clamped.value(), height_m);
  if (!cap) return cap.error();
  if (height_m == 0.0) {
    if (const auto fold_m = find_fold_in_flat(cap.value())) return flat_cap_folds(*fold_m);
  }
  JoinRequest capping = request;
  capping.shared_parameters = true;
  if (height_m == 0.0) capping.continuity = 0;
  auto joined = join_row({std::move(clamped).value(), std::move(cap).value()}, capping);
  if (!joined) return joined.error();
  joined->surface = turn_back(joined->surface, side);
  return joined;
}

Result<Surface> open_pole(const Surface& surface, Side side, double wide_enough_m) {
  SPOONBILL_ASSERT(wide_enough_m >= 0.0);
  if (!is_tube(surface) || !is_pole(surface, side)) {
    return Error(ErrorCode::mismatch,
                 std::string(side_name(side)) + " is not the pole of a tube; choose one that is");
  }
  const Surface along = with_end_at_v_end(surface, side);
  const double start = along.v.domain_start(), end = along.v.domain_end();
  constexpr int steps = 400;
  constexpr double straight = 0.1;
  RingSize last = ring_at(along, end);
  for (int k = 1; k < steps / 2; ++k) {
    const double v = end + (start - end) * k / steps;
    const RingSize ring = ring_at(along, v);
    const double step_m = (ring.centre_m - last.centre_m).norm();
    const bool is_straight = k > 2 && ring.radius_m - last.radius_m < straight * step_m;
    if (is_straight || ring.radius_m >= wide_enough_m) {
      auto cut = part_of(along, Direction::v, start, v);
      if (!cut) return cut.error();
      return turn_back(cut.value(), side);
    }
    last = ring;
  }
  return Error(ErrorCode::degenerate,
               "the tube has no straight sides near its " + std::string(side_name(side)) +
                   ", where it could be opened; cut it there, or let it intersect the other");
}

std::vector<std::pair<PatchEdge, PatchEdge>> find_nearest_ends(const std::vector<Surface>& tubes) {
  struct Pair {
    PatchEdge a, b;
    double cost_m;
  };
  // Weight of the difference in width in the cost of joining two ends. The centre of a flat disc may be as
  // near to a ring as the disc's edge is; an end of similar width is then preferred.
  constexpr double width_fraction = 0.01;
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
      pairs.push_back({ends[a].first, ends[b].first,
                       (one.centre_m - other.centre_m).norm() +
                           width_fraction * std::abs(one.radius_m - other.radius_m)});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.cost_m < b.cost_m; });
  std::vector<int> group(tubes.size());
  std::iota(group.begin(), group.end(), 0);
  std::vector<PatchEdge> used;
  std::vector<std::pair<PatchEdge, PatchEdge>> chosen;
  for (const Pair& pair : pairs) {
    const bool is_used = std::any_of(used.begin(), used.end(),
                                     [&](const PatchEdge& end) { return end == pair.a || end == pair.b; });
    const int from = group[pair.b.patch], to = group[pair.a.patch];
    if (is_used || from == to) continue;
    std::replace(group.begin(), group.end(), from, to);
    used.insert(used.end(), {pair.a, pair.b});
    chosen.emplace_back(pair.a, pair.b);
  }
  return chosen;
}

}  // namespace spoonbill
