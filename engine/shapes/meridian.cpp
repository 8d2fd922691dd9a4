#include "engine/shapes/meridian.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

// Of the whole profile: what rounding errors leave of a piece that is not there.
constexpr double least_piece = 1e-9;

double cross(const MeridianPoint& a, const MeridianPoint& b) {
  return a.x() * b.y() - a.y() * b.x();
}

MeridianPoint direction_at(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

double angle_of(const MeridianPoint& direction) {
  return std::atan2(direction.y(), direction.x());
}

// The corner between two directions: how far it turns to the left, and what a rounding takes of either side.
struct Corner {
  MeridianPoint before, after;
  double turn = 0.0;

  Corner(const MeridianPoint& before_corner, const MeridianPoint& after_corner)
      : before(before_corner),
        after(after_corner),
        turn(std::atan2(cross(before, after), before.dot(after))) {}
  double taken(double rounding) const { return rounding * std::tan(0.5 * std::abs(turn)); }
  // From the corner's start on, the centre of its arc.
  MeridianPoint to_centre(double rounding) const {
    return std::copysign(rounding, turn) * MeridianPoint(-before.y(), before.x());
  }
  double from() const { return angle_of(-to_centre(1.0)); }
};

// The profile's mirror image goes on beyond the axis.
MeridianPoint mirrored(const MeridianPoint& direction) {
  return {direction.x(), -direction.y()};
}

std::vector<Corner> corners_of(std::span<const MeridianPoint> vertices) {
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
  const std::vector<Corner> corners = corners_of(vertices);
  double whole = 0.0;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) whole += (vertices[k + 1] - vertices[k]).norm();
  const std::size_t last = vertices.size() - 1;
  Meridian meridian;
  const auto add_rounding = [&](std::size_t k, double share_from, double share) {
    const Corner& corner = corners[k];
    if (roundings[k] * std::abs(corner.turn) * share < least_piece * whole) return;
    const MeridianPoint begin = vertices[k] - corner.taken(roundings[k]) * corner.before;
    meridian.add_arc(begin + corner.to_centre(roundings[k]), roundings[k],
                     corner.from() + share_from * corner.turn, share * corner.turn);
  };
  add_rounding(0, 0.5, 0.5);
  for (std::size_t k = 0; k < last; ++k) {
    const double side = (vertices[k + 1] - vertices[k]).norm();
    const double start = corners[k].taken(roundings[k]), end = corners[k + 1].taken(roundings[k + 1]);
    const MeridianPoint& along = corners[k + 1].before;
    if (start + end > side + least_piece * whole) {
      return Error{"roundings of " + length_text(roundings[k]) + " and " + length_text(roundings[k + 1]) +
                   " do not fit on a side of " + length_text(side) + "; make them smaller"};
    }
    if (side - start - end > least_piece * whole) {
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
  const double share = std::clamp((distance_m - starts_[k]) / (starts_[k + 1] - starts_[k]), 0.0, 1.0);
  if (!(piece.radius > 0.0)) return piece.start + share * (piece.end - piece.start);
  return piece.centre + piece.radius * direction_at(piece.from + share * piece.sweep);
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

}  // namespace spoonbill
