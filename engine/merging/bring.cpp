#include "engine/merging/bring.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/bspline/evaluate.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {
namespace {

// Number of points of a ring that are compared.
constexpr int ring_points = 360;
// A ring is round if no pairing of its points has an error that differs by more, for a ring of size 1.
constexpr double round_error = 1e-5;
// Rolls match alike if their errors differ by at most this fraction of the largest difference.
constexpr double alike = 0.05;

// An edge, its centre and direction, and what decides the roll: the points of a ring, or a normal.
struct EdgeFrame {
  Vector3 centre_m = Vector3::Zero(), outward = Vector3::Zero(), normal = Vector3::Zero();
  bool is_tube = false;
  std::vector<Vector3> ring_m;  // from the centre of the ring; empty for a pole without straight sides
};

Vector3 mean_of(const std::vector<Vector3>& points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// Returns the mean normal of a patch along an edge.
Vector3 mean_normal(const Surface& surface, Side side, const std::vector<double>& parameters) {
  const KnotVector& across_knots = knots_along(surface, across(side));
  const double at = is_start(side) ? across_knots.domain_start() : across_knots.domain_end();
  Vector3 sum = Vector3::Zero();
  for (const double along : parameters) {
    sum += across(side) == Direction::u ? unit_normal(surface, at, along) : unit_normal(surface, along, at);
  }
  return sum.normalized();
}

Result<EdgeFrame> find_frame(const Surface& surface, Side side) {
  EdgeFrame frame;
  frame.is_tube = is_tube(surface);
  if (frame.is_tube) {
    const TubeEnd end = tube_end(surface, side);
    frame.centre_m = end.centre_m;
    frame.outward = end.outward;
    const auto open = is_pole(surface, side)
                          ? open_pole(surface, side, std::numeric_limits<double>::infinity())
                          : Result<Surface>(surface);
    if (open) frame.ring_m = edge_samples(edge_curve(open.value(), side), ring_points).points_m;
    if (!frame.ring_m.empty()) {
      const Vector3 ring_centre_m = mean_of(frame.ring_m);
      for (Vector3& point : frame.ring_m) point -= ring_centre_m;
    }
  } else {
    if (!is_joinable(surface, side)) {
      return Error{ErrorCode::unsupported,
                   std::string(side_name(side)) + " is a point or closed; choose an edge"};
    }
    const EdgeSamples samples = edge_samples(edge_curve(surface, side), ring_points);
    frame.centre_m = mean_of(samples.points_m);
    frame.outward = outward(surface, side);
    frame.normal = mean_normal(surface, side, samples.parameters);
  }
  if (!(frame.outward.norm() > 0.5)) {
    return Error{ErrorCode::degenerate,
                 std::string(side_name(side)) + " does not lead out of the part in one direction"};
  }
  frame.outward.normalize();
  return frame;
}

// Returns the smallest turn that maps `from` to `to`. Between opposite directions, it is about the vertical,
// which keeps the upper side up, or about z if they are vertical.
Quaternion smallest_turn(const Vector3& from, const Vector3& to) {
  constexpr double opposite_cosine = -1.0 + 1e-9;
  if (from.dot(to) > opposite_cosine) return Quaternion::FromTwoVectors(from, to);
  const bool is_vertical = std::abs(to.y()) > 0.99;
  const Vector3 up = is_vertical ? Vector3::UnitZ() : Vector3::UnitY();
  return Quaternion(Eigen::AngleAxisd(std::numbers::pi, (up - up.dot(to) * to).normalized()));
}

// Points of a ring in the plane across an axis.
using PlaneRing = std::vector<Vector2>;

PlaneRing project(const std::vector<Vector3>& ring_m, const Vector3& one, const Vector3& other) {
  PlaneRing ring;
  for (const Vector3& point : ring_m) ring.emplace_back(one.dot(point), other.dot(point));
  const auto area = [&] {
    double twice = 0.0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vector2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return twice;
  };
  if (area() < 0.0) std::reverse(ring.begin(), ring.end());
  // Rings of different size match by their shape.
  double square = 0.0;
  for (const Vector2& point : ring) square += point.squaredNorm();
  const double size = std::sqrt(square / static_cast<double>(ring.size()));
  for (Vector2& point : ring) point /= std::max(size, 1e-12);
  return ring;
}

// The best turn of a ring whose points are paired with those of another one, and its mean squared error.
struct Match {
  double angle = 0.0, error = 0.0;
};

// Pairs point k of `still` with point k + shift of `moved`, between two points for a fraction of a shift.
Match match_rings(const PlaneRing& still, const PlaneRing& moved, double shift) {
  const auto count = static_cast<double>(still.size());
  double along = 0.0, across = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < still.size(); ++k) {
    double place = std::fmod(static_cast<double>(k) + shift, count);
    if (place < 0.0) place += count;
    const std::size_t before = static_cast<std::size_t>(place) % moved.size();
    const double part = place - std::floor(place);
    const Vector2 point = (1.0 - part) * moved[before] + part * moved[(before + 1) % moved.size()];
    along += still[k].dot(point);
    across += point.x() * still[k].y() - point.y() * still[k].x();
    squares += still[k].squaredNorm() + point.squaredNorm();
  }
  return {std::atan2(across, along), (squares - 2.0 * std::hypot(along, across)) / count};
}

// Returns the best match within a point of `shift`.
Match refine_match(const PlaneRing& still, const PlaneRing& moved, double shift) {
  constexpr double golden = 0.6180339887498949;
  double low = shift - 1.0, high = shift + 1.0;
  for (int step = 0; step < 40; ++step) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (match_rings(still, moved, a).error < match_rings(still, moved, b).error) {
      high = b;
    } else {
      low = a;
    }
  }
  return match_rings(still, moved, 0.5 * (low + high));
}

// Returns the roll of `moved`, in the plane of the rings, at which they match best; of those that match
// alike, the smallest. Round rings need no roll.
double find_ring_roll(const PlaneRing& still, const PlaneRing& moved) {
  std::vector<Match> matches;
  for (int shift = 0; shift < ring_points; ++shift) matches.push_back(match_rings(still, moved, shift));
  const auto [least, most] =
      std::minmax_element(matches.begin(), matches.end(),
                          [](const Match& one, const Match& other) { return one.error < other.error; });
  if (most->error - least->error < round_error) return 0.0;
  const double enough = least->error + alike * (most->error - least->error);
  std::optional<int> best;
  for (int shift = 0; shift < ring_points; ++shift) {
    const auto at = [&](int k) -> const Match& {
      return matches[static_cast<std::size_t>((k + ring_points) % ring_points)];
    };
    const bool is_minimum = at(shift).error <= at(shift - 1).error && at(shift).error <= at(shift + 1).error;
    if (!is_minimum || at(shift).error > enough) continue;
    if (!best || std::abs(at(shift).angle) < std::abs(at(*best).angle)) best = shift;
  }
  return refine_match(still, moved, best.value_or(0)).angle;
}

}  // namespace

Result<Bringing> bring(const Surface& still, Side still_side, const Surface& moved, Side moved_side) {
  const auto to = find_frame(still, still_side), from = find_frame(moved, moved_side);
  if (!to) return to.error();
  if (!from) return from.error();
  if (to->is_tube != from->is_tube) {
    return Error{ErrorCode::mismatch, "one part is a tube and the other is not; choose edges of one kind"};
  }
  const Vector3& axis = to->outward;
  const Quaternion turn = smallest_turn(from->outward, -axis);
  Bringing bringing;
  if (!to->is_tube) {
    const auto across_axis = [&](const Vector3& v) -> Vector3 { return v - v.dot(axis) * axis; };
    const Vector3 wanted = across_axis(to->normal), present = across_axis(turn * from->normal);
    bringing.roll_rad = std::atan2(present.cross(wanted).dot(axis), present.dot(wanted));
  } else if (!to->ring_m.empty() && !from->ring_m.empty()) {
    const Vector3 one = axis.unitOrthogonal(), other = axis.cross(one);
    std::vector<Vector3> turned_m;
    for (const Vector3& point : from->ring_m) turned_m.push_back(turn * point);
    bringing.roll_rad = find_ring_roll(project(to->ring_m, one, other), project(turned_m, one, other));
  }
  bringing.pose.orientation = Quaternion(Eigen::AngleAxisd(bringing.roll_rad, axis)) * turn;
  bringing.pose.orientation.normalize();
  bringing.moved_m = to->centre_m - from->centre_m;
  bringing.pose.position_m = to->centre_m - bringing.pose.orientation * from->centre_m;
  return bringing;
}

namespace {

std::string patch_text(int patch) {
  return "patch " + std::to_string(patch + 1);
}

// Returns the free ends of a part before `part` and of `part` that are nearest to each other.
std::pair<PatchEdge, PatchEdge> find_nearest_pair(const std::vector<Surface>& parts, int part,
                                                  const std::vector<PatchEdge>& used) {
  const auto ends_of = [&](int which) {
    const auto [first, last] = tube_sides(parts[static_cast<std::size_t>(which)]);
    return std::array{PatchEdge{which, first}, PatchEdge{which, last}};
  };
  const auto centre_of = [&](const PatchEdge& end) {
    return tube_end(parts[static_cast<std::size_t>(end.patch)], end.side).centre_m;
  };
  std::pair<PatchEdge, PatchEdge> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (int other = 0; other < part; ++other) {
    for (const PatchEdge& to : ends_of(other)) {
      if (std::find(used.begin(), used.end(), to) != used.end()) continue;
      for (const PatchEdge& from : ends_of(part)) {
        const double distance_m = (centre_of(to) - centre_of(from)).norm();
        if (!(distance_m < least_m)) continue;
        least_m = distance_m;
        nearest = {to, from};
      }
    }
  }
  return nearest;
}

// Parts that were moved or stay, and the ends that meet.
struct Bringer {
  std::vector<Surface>& parts;
  std::vector<BroughtPart> brought = {};
  std::vector<PatchEdge> used = {};

  Status add(const PatchEdge& to, const PatchEdge& from) {
    Surface& moved = parts[static_cast<std::size_t>(from.patch)];
    const auto motion = bring(parts[static_cast<std::size_t>(to.patch)], to.side, moved, from.side);
    if (!motion) return motion.error().in(patch_text(to.patch) + " and " + patch_text(from.patch));
    moved = placed(std::move(moved), motion->pose);
    brought.push_back({to, from, motion.value()});
    used.insert(used.end(), {to, from});
    return {};
  }
};

Status bring_chosen(const std::vector<ChosenEdges>& chosen, Bringer& bringer) {
  std::vector<bool> stays(bringer.parts.size(), false);
  stays[0] = true;
  const auto find_next = [&] {
    return std::find_if(chosen.begin(), chosen.end(), [&](const ChosenEdges& edges) {
      return stays[static_cast<std::size_t>(edges.a.patch)] != stays[static_cast<std::size_t>(edges.b.patch)];
    });
  };
  for (auto next = find_next(); next != chosen.end(); next = find_next()) {
    const bool first_stays = stays[static_cast<std::size_t>(next->a.patch)];
    const PatchEdge &to = first_stays ? next->a : next->b, &from = first_stays ? next->b : next->a;
    if (Status added = bringer.add(to, from); !added) return added;
    stays[static_cast<std::size_t>(from.patch)] = true;
  }
  const auto lost = std::find(stays.begin(), stays.end(), false);
  if (lost == stays.end()) return {};
  return Error{ErrorCode::missing, patch_text(static_cast<int>(lost - stays.begin())) +
                                       " is not connected with patch 1 by chosen edges; name a pair for it"};
}

Status bring_nearest(Bringer& bringer) {
  for (int part = 0; part < static_cast<int>(bringer.parts.size()); ++part) {
    if (!is_tube(bringer.parts[static_cast<std::size_t>(part)])) {
      return Error{ErrorCode::unsupported,
                   patch_text(part) + " is not a tube; name the edges that are to meet"};
    }
  }
  for (int part = 1; part < static_cast<int>(bringer.parts.size()); ++part) {
    const auto [to, from] = find_nearest_pair(bringer.parts, part, bringer.used);
    if (Status added = bringer.add(to, from); !added) return added;
  }
  return {};
}

}  // namespace

Result<std::vector<BroughtPart>> bring_parts(std::vector<Surface>& parts, const MergeRequest& request) {
  if (Status checked = check_merge(parts, request); !checked) return checked.error();
  Bringer bringer{parts};
  const Status done = request.chosen.empty() ? bring_nearest(bringer) : bring_chosen(request.chosen, bringer);
  if (!done) return done.error();
  return std::move(bringer.brought);
}

}  // namespace spoonbill
