#include "engine/shapes/lathe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

namespace {

// Smallest length of a line or an arc, as a fraction of the whole profile. A shorter piece is a rounding
// error and is omitted.
constexpr double min_piece = 1e-9;

double cross(const MeridianPoint& a, const MeridianPoint& b) {
  return a.x() * b.y() - a.y() * b.x();
}

MeridianPoint direction_at(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

double direction_angle(const MeridianPoint& direction) {
  return std::atan2(direction.y(), direction.x());
}

// A corner of a profile: the directions of the sides before and after it, and the angle by which the profile
// turns to the left.
struct Corner {
  MeridianPoint before, after;
  double turn = 0.0;

  Corner(const MeridianPoint& before_corner, const MeridianPoint& after_corner)
      : before(before_corner),
        after(after_corner),
        turn(std::atan2(cross(before, after), before.dot(after))) {}
  double removed_length(double rounding) const { return rounding * std::tan(0.5 * std::abs(turn)); }
  // Returns the vector from the start of the corner's arc to its centre.
  MeridianPoint to_centre(double rounding) const {
    return std::copysign(rounding, turn) * MeridianPoint(-before.y(), before.x());
  }
  double from() const { return direction_angle(-to_centre(1.0)); }
};

// Returns the direction of the profile's mirror image in the axis, given the direction of the profile. The
// mirror image is traversed backwards, so that the profile and its image form one continuous curve.
MeridianPoint mirrored(const MeridianPoint& direction) {
  return {direction.x(), -direction.y()};
}

std::vector<Corner> find_corners(std::span<const MeridianPoint> vertices) {
  std::vector<MeridianPoint> sides;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    sides.emplace_back((vertices[k + 1] - vertices[k]).normalized());
  }
  std::vector<Corner> corners;
  corners.emplace_back(mirrored(sides.front()), sides.front());
  for (std::size_t k = 1; k < sides.size(); ++k) corners.emplace_back(sides[k - 1], sides[k]);
  corners.emplace_back(sides.back(), mirrored(sides.back()));
  return corners;
}

}  // namespace

void Meridian::add_line(const MeridianPoint& start, const MeridianPoint& end) {
  const double length = (end - start).norm();
  pieces_.push_back({start, end, MeridianPoint::Zero(), 0.0, 0.0, 0.0});
  starts_.push_back(starts_.back() + length);
}

void Meridian::add_arc(const MeridianPoint& centre, double radius, double from, double sweep) {
  pieces_.push_back({centre + radius * direction_at(from), centre + radius * direction_at(from + sweep),
                     centre, radius, from, sweep});
  starts_.push_back(starts_.back() + radius * std::abs(sweep));
}

Result<Meridian> Meridian::rounded(std::span<const MeridianPoint> vertices,
                                   std::span<const double> roundings) {
  SPOONBILL_ASSERT(vertices.size() >= 2 && vertices.size() == roundings.size());
  const std::vector<Corner> corners = find_corners(vertices);
  double whole = 0.0;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) whole += (vertices[k + 1] - vertices[k]).norm();
  const std::size_t last = vertices.size() - 1;
  Meridian meridian;
  const auto add_rounding = [&](std::size_t k, double fraction_from, double fraction) {
    const Corner& corner = corners[k];
    if (roundings[k] * std::abs(corner.turn) * fraction < min_piece * whole) return;
    const MeridianPoint begin = vertices[k] - corner.removed_length(roundings[k]) * corner.before;
    meridian.add_arc(begin + corner.to_centre(roundings[k]), roundings[k],
                     corner.from() + fraction_from * corner.turn, fraction * corner.turn);
  };
  add_rounding(0, 0.5, 0.5);
  for (std::size_t k = 0; k < last; ++k) {
    const double side = (vertices[k + 1] - vertices[k]).norm();
    const double start = corners[k].removed_length(roundings[k]),
                 end = corners[k + 1].removed_length(roundings[k + 1]);
    const MeridianPoint& along = corners[k + 1].before;
    if (start + end > side + min_piece * whole) {
      return Error{ErrorCode::out_of_range,
                   "roundings of " + length_text(roundings[k]) + " and " + length_text(roundings[k + 1]) +
                       " do not fit on a side of " + length_text(side) + "; make them smaller",
                   "rounding"};
    }
    if (side - start - end > min_piece * whole) {
      meridian.add_line(vertices[k] + start * along, vertices[k + 1] - end * along);
    }
    add_rounding(k + 1, 0.0, k + 1 == last ? 0.5 : 1.0);
  }
  return meridian;
}

Meridian Meridian::half_circle(double radius_m) {
  SPOONBILL_ASSERT(radius_m > 0.0);
  Meridian meridian;
  meridian.add_arc({0.0, 0.0}, radius_m, -0.5 * std::numbers::pi, std::numbers::pi);
  return meridian;
}

MeridianPoint Meridian::at(double distance_m) const {
  SPOONBILL_ASSERT_DEBUG(!pieces_.empty());
  const auto after = std::upper_bound(starts_.begin() + 1, starts_.end() - 1, distance_m);
  const std::size_t k = static_cast<std::size_t>(after - starts_.begin()) - 1;
  const Piece& piece = pieces_[k];
  const double fraction = std::clamp((distance_m - starts_[k]) / (starts_[k + 1] - starts_[k]), 0.0, 1.0);
  if (!(piece.radius > 0.0)) return piece.start + fraction * (piece.end - piece.start);
  return piece.centre + piece.radius * direction_at(piece.from + fraction * piece.sweep);
}

ExactShape revolved_shape(Meridian meridian) {
  SPOONBILL_ASSERT(meridian.length_m() > 0.0);
  ExactShape shape;
  const double length = meridian.length_m();
  shape.u.periodic = true;
  shape.v.breaks.clear();
  for (const double start : meridian.breaks_m()) shape.v.breaks.push_back(start / length);
  shape.v.breaks.back() = 1.0;
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [meridian = std::move(meridian), length](double u, double v) {
    const MeridianPoint point = meridian.at(v * length);
    const double radius = v <= 0.0 || v >= 1.0 ? 0.0 : point.x(), angle = 2.0 * std::numbers::pi * u;
    return Vector3(radius * std::cos(angle), point.y(), -radius * std::sin(angle));
  };
  return shape;
}

namespace {

constexpr int samples = 600;

std::string profile_point_text(const Vector3& point_m) {
  return "radius " + short_length_text(point_m.x()) + ", height " + short_length_text(point_m.y());
}

std::vector<Vector3> sample_curve(const SmoothCurve& profile) {
  std::vector<Vector3> points;
  for (int k = 0; k <= samples; ++k) points.push_back(profile.at(profile.end() * k / samples));
  return points;
}

double cross_xy(const Vector3& a, const Vector3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Returns true if the segment from a to b crosses the segment from c to d.
bool crosses(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return cross_xy(b - a, c - a) * cross_xy(b - a, d - a) < 0.0 &&
         cross_xy(d - c, a - c) * cross_xy(d - c, b - c) < 0.0;
}

Status check_profile(const std::vector<Vector3>& points, bool pole_first, bool pole_last) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool at_pole = (k == 0 && pole_first) || (k + 1 == points.size() && pole_last);
    if (!at_pole && !(points[k].x() > 0.0)) {
      return Error{ErrorCode::malformed, "the curve through the profile's points crosses the axis near " +
                                             profile_point_text(points[k]) + "; add points there"};
    }
  }
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    for (std::size_t other = k + 2; other + 1 < points.size(); ++other) {
      if (crosses(points[k], points[k + 1], points[other], points[other + 1])) {
        return Error{ErrorCode::self_intersecting,
                     "the profile crosses itself near " + profile_point_text(points[k])};
      }
    }
  }
  return {};
}

// Returns the enclosed volume divided by pi. It is positive if the outer part of the profile runs upwards.
double signed_volume(const std::vector<Vector3>& points) {
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const double radius = 0.5 * (points[k].x() + points[k + 1].x());
    sum += radius * radius * (points[k + 1].y() - points[k].y());
  }
  return sum;
}

ExactShape revolve(const SmoothCurve& profile, bool pole_first, bool pole_last) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.v.periodic = profile.closed();
  shape.pole_at_start = pole_first;
  shape.pole_at_end = pole_last;
  shape.at = [=](double u, double v) {
    const Vector3 point = profile.at(v * profile.end());
    const bool at_pole = (pole_first && v <= 0.0) || (pole_last && v >= 1.0);
    const double radius = at_pole ? 0.0 : point.x(), angle = 2.0 * std::numbers::pi * u;
    return Vector3(radius * std::cos(angle), point.y(), -radius * std::sin(angle));
  };
  return shape;
}

}  // namespace

Result<ExactShape> lathe_shape(const std::vector<MeridianPoint>& profile_m) {
  std::vector<Vector3> points;
  double reach = 0.0;
  for (const MeridianPoint& point : profile_m) {
    if (!(point.x() >= 0.0) || !std::isfinite(point.y())) {
      return Error{ErrorCode::out_of_range,
                   "point " + std::to_string(points.size() + 1) + " of the profile has a radius of " +
                       short_length_text(point.x()) + "; radii must not be negative"};
    }
    points.emplace_back(point.x(), point.y(), 0.0);
    reach = std::max(reach, (points.back() - points.front()).norm());
  }
  if (points.size() < 2) return Error{ErrorCode::too_few, "a profile needs at least 2 points"};
  if (Status status = check_size("the profile's size", reach); !status) return status.error();
  const double on_axis = 1e-6 * reach;
  const bool closed =
      points.size() > 3 && (points.back() - points.front()).norm() <= on_axis && points.front().x() > on_axis;
  if (closed) points.pop_back();
  bool pole_first = !closed && points.front().x() <= on_axis;
  bool pole_last = !closed && points.back().x() <= on_axis;
  if (pole_first) points.front().x() = 0.0;
  if (pole_last) points.back().x() = 0.0;
  CurveEnds first, last;
  first.level_y = pole_first;
  last.level_y = pole_last;
  auto curve = SmoothCurve::through(points, closed, first, last);
  if (!curve) return curve.error().in("profile");
  const std::vector<Vector3> points_m = sample_curve(curve.value());
  if (Status status = check_profile(points_m, pole_first, pole_last); !status) return status.error();
  if (signed_volume(points_m) < 0.0) {
    std::reverse(points.begin(), points.end());
    std::swap(pole_first, pole_last);
    std::swap(first, last);
    curve = SmoothCurve::through(points, closed, first, last);
  }
  return revolve(curve.value(), pole_first, pole_last);
}

}  // namespace spoonbill
