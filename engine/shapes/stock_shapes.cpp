#include "engine/shapes/stock_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/lathe.h"

namespace spoonbill {

namespace {

// A rectangle with rounded corners, centred at the origin. It is parametrised by arc length from the midpoint
// of the side at +x, in the direction of +y.
class RoundedRectangle {
 public:
  RoundedRectangle(double half_x, double half_y, double rounding)
      : half_x_(half_x), half_y_(half_y), rounding_(rounding) {
    const double arc = 0.5 * std::numbers::pi * rounding;
    const double flat_x = 2.0 * (half_x - rounding), flat_y = 2.0 * (half_y - rounding);
    const std::array<double, 9> pieces = {0.5 * flat_y, arc,    flat_x, arc,         flat_y,
                                          arc,          flat_x, arc,    0.5 * flat_y};
    std::partial_sum(pieces.begin(), pieces.end(), ends_.begin() + 1);
  }

  double length() const { return ends_.back(); }
  double rounding() const { return rounding_; }

  // Returns the breaks of the outline as fractions of its length, from 0 to 1. Breaks are where a side meets
  // a corner, and where the part of a side in which at() slows down begins or ends.
  std::vector<double> breaks() const {
    std::vector<double> fractions = {0.0};
    const auto add = [&](double distance) {
      const double fraction = distance / length();
      if (fraction > fractions.back() + 1e-9) fractions.push_back(fraction);
    };
    for (std::size_t piece = 0; piece + 1 < ends_.size(); ++piece) {
      const double start = ends_[piece], end = ends_[piece + 1];
      const bool is_side = piece % 2 == 0;
      const bool from_centre = piece == 0, to_centre = piece + 2 == ends_.size();
      if (is_side && !from_centre && end - start > (to_centre ? 1.0 : 2.0) * slowed()) add(start + slowed());
      if (is_side && !to_centre && end - start > (from_centre ? 1.0 : 2.0) * slowed()) add(end - slowed());
      add(end);
    }
    fractions.back() = 1.0;
    return fractions;
  }

  struct Point {
    Vector2 position, normal;
  };

  // Returns the point at a fraction of the length. If the outline is shrunk, the arcs at its corners become
  // shorter, and a point moves along them only at `speed_at_corners` times its speed on the sides. The point
  // therefore slows down to this speed near the ends of the sides. A curve through a side and a corner then
  // needs no extra knots to stay smooth.
  Point at(double fraction, double speed_at_corners) const {
    const double distance = fraction * length();
    const auto after = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, distance);
    const int piece = static_cast<int>(after - ends_.begin()) - 1;
    const double from = ends_[static_cast<std::size_t>(piece)], along = distance - from;
    const double x = half_x_ - rounding_, y = half_y_ - rounding_;
    const auto off_centre = [&](double half_side, double off) {
      return position_on_side(half_side, off, 1.0 - speed_at_corners);
    };
    switch (piece) {
      case 0:
        return {{half_x_, off_centre(y, along)}, Vector2::UnitX()};
      case 2:
        return {{off_centre(x, x - along), half_y_}, Vector2::UnitY()};
      case 4:
        return {{-half_x_, off_centre(y, y - along)}, -Vector2::UnitX()};
      case 6:
        return {{off_centre(x, along - x), -half_y_}, -Vector2::UnitY()};
      case 8:
        return {{half_x_, off_centre(y, along - y)}, Vector2::UnitX()};
      default:
        return corner(piece, along);
    }
  }

 private:
  // Returns the length of the part of a side, next to a corner, in which the points of at() lie closer
  // together. This length keeps the lines across the outline nearly straight.
  double slowed() const { return 4.0 * rounding_; }

  // Returns the position on a side, measured from its centre. Points lie closer together, by the fraction
  // `slower`, at each end of the side: over the length slowed() or, if half the side is shorter, from the
  // centre on. There the position is a cubic function of `off_centre`.
  double position_on_side(double half_side, double off_centre, double slower) const {
    if (!(half_side > 0.0)) return 0.0;
    if (half_side <= slowed()) {
      const double part = off_centre / half_side;
      return off_centre * (1.0 + 0.5 * slower * (1.0 - part * part));
    }
    const double part = std::min(1.0, (half_side - std::abs(off_centre)) / slowed());
    return off_centre + std::copysign(slower * slowed() * part * (1.0 - part) * (1.0 - part), off_centre);
  }

  Point corner(int piece, double along) const {
    const int quarter = (piece - 1) / 2;
    const double angle = 0.5 * std::numbers::pi * quarter + along / rounding_;
    const Vector2 centre(quarter == 0 || quarter == 3 ? half_x_ - rounding_ : rounding_ - half_x_,
                         quarter < 2 ? half_y_ - rounding_ : rounding_ - half_y_);
    const Vector2 normal(std::cos(angle), std::sin(angle));
    return {centre + rounding_ * normal, normal};
  }

  double half_x_, half_y_, rounding_;
  std::array<double, 10> ends_{};
};

// A box whose end faces are perpendicular to its third axis. Its lines of constant v are outlines of its
// section. Towards an end, these outlines first follow the rounded edge and then shrink to the centre of the
// end face.
class BoxAlong {
 public:
  BoxAlong(const Vector3& half_m, double edge_rounding_m, double end_rounding_m)
      : half_(half_m),
        rounding_(end_rounding_m),
        outline_(half_m.x(), half_m.y(), edge_rounding_m),
        face_(face_length(half_m.x() - end_rounding_m, half_m.y() - end_rounding_m)),
        roll_(0.5 * std::numbers::pi * end_rounding_m),
        side_(2.0 * (half_m.z() - end_rounding_m)) {}

  std::vector<double> around_breaks() const { return outline_.breaks(); }

  std::vector<double> along_breaks() const {
    std::vector<double> breaks = {0.0};
    for (const double length : {face_, roll_, side_, roll_, face_}) {
      if (length > 1e-9 * whole()) breaks.push_back(breaks.back() + length / whole());
    }
    breaks.back() = 1.0;
    return breaks;
  }

  Vector3 at(double u, double v) const {
    const double distance = std::clamp(v, 0.0, 1.0) * whole();
    const double end = face_ + roll_;
    if (distance < end) return on_end(u, distance, -1.0);
    if (whole() - distance < end) return on_end(u, whole() - distance, 1.0);
    const RoundedRectangle::Point ring = outline_.at(u, 1.0);
    return {ring.position.x(), ring.position.y(), distance - end - half_.z() + rounding_};
  }

 private:
  // Returns the length along v of an end face: the mean distance from the pole to the edge, limited so that
  // every line leaves the pole towards the edge.
  static double face_length(double half_x, double half_y) {
    return std::min(0.5 * (half_x + half_y), 1.6 * std::min(half_x, half_y));
  }

  double whole() const { return 2.0 * (face_ + roll_) + side_; }

  // Returns the position on a line from the pole to the edge of the end face, as a fraction of the line's
  // length. The derivative with respect to `from_pole` is continuous at the edge, where the line continues
  // over the rounding.
  double fraction_from_pole(double half, double from_pole) const {
    const double speed = face_ / (half - rounding_), fraction = from_pole / face_;
    return fraction * (2.0 - speed - (1.0 - speed) * fraction);
  }

  Vector3 on_end(double u, double from_pole, double end) const {
    const double angle = std::max(0.0, (from_pole - face_) / rounding_);
    const double inwards = rounding_ * (1.0 - std::sin(angle));
    const RoundedRectangle::Point ring = outline_.at(u, 1.0 - inwards / outline_.rounding());
    const Vector2 inner = ring.position - rounding_ * ring.normal;
    if (from_pole < face_) {
      return {fraction_from_pole(half_.x(), from_pole) * inner.x(),
              fraction_from_pole(half_.y(), from_pole) * inner.y(), end * half_.z()};
    }
    const Vector2 point = inner + rounding_ * std::sin(angle) * ring.normal;
    return {point.x(), point.y(), end * (half_.z() - rounding_ * (1.0 - std::cos(angle)))};
  }

  Vector3 half_;
  double rounding_;
  RoundedRectangle outline_;
  // Lengths along v of an end face, of the rounding at its edge, and of the sides.
  double face_, roll_, side_;
};

// Returns the axis through the end faces. It is the longest axis, unless the faces at its ends are slender
// and the faces at the ends of the shortest axis are squarer. Slender end faces would have slender cells
// around the poles.
int box_axis(const Vector3& size_m) {
  std::array<int, 3> order = {2, 1, 0};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size_m[a] < size_m[b]; });
  const double along_longest = size_m[order[1]] / size_m[order[0]];
  const double along_shortest = size_m[order[2]] / size_m[order[1]];
  constexpr double square_enough = 3.0;
  return along_longest <= std::max(square_enough, along_shortest) ? order[2] : order[0];
}

Status check_sides(const Vector3& size_m) {
  constexpr std::array<const char*, 3> names = {"size along x", "size along y", "size along z"};
  for (int axis = 0; axis < 3; ++axis) {
    Status status = check_size(names[static_cast<std::size_t>(axis)], size_m[axis]);
    if (!status) return status;
  }
  return {};
}

ExactShape shape_along(const Vector3& size_m, int axis, double edge_rounding_m, double end_rounding_m) {
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  const BoxAlong box(0.5 * Vector3(size_m[first], size_m[second], size_m[axis]), edge_rounding_m,
                     end_rounding_m);
  ExactShape shape;
  shape.u.periodic = true;
  shape.u.breaks = box.around_breaks();
  shape.v.breaks = box.along_breaks();
  shape.pole_at_start = shape.pole_at_end = true;
  shape.flat_to = shape.v.breaks[1];
  shape.flat_from = shape.v.breaks[shape.v.breaks.size() - 2];
  shape.at = [=](double u, double v) {
    const Vector3 along = box.at(u, v);
    Vector3 point;
    point[first] = along.x();
    point[second] = along.y();
    point[axis] = along.z();
    return point;
  };
  return shape;
}

}  // namespace

double default_rounding_m(const BoxSize& size) {
  return default_rounding_fraction * size.size_m.minCoeff();
}

Result<ExactShape> box_shape(const BoxSize& size) {
  if (Status status = check_sides(size.size_m); !status) return status.error();
  const double shortest = size.size_m.minCoeff();
  const Status status =
      check_rounding("rounding", size.rounding_m, shortest, max_box_rounding_fraction * shortest);
  if (!status) return status.error();
  return shape_along(size.size_m, box_axis(size.size_m), std::min(2.0 * size.rounding_m, 0.5 * shortest),
                     size.rounding_m);
}

double default_corner_m(const PlateSize& size) {
  return std::max(size.thickness_m, default_rounding_fraction * std::min(size.x_size_m, size.z_size_m));
}

Result<ExactShape> plate_shape(const PlateSize& size) {
  const Vector3 sides(size.x_size_m, size.thickness_m, size.z_size_m);
  if (Status status = check_sides(sides); !status) return status.error();
  const double shorter = std::min(size.x_size_m, size.z_size_m);
  if (!(2.0 * size.thickness_m <= shorter)) {
    return Error{ErrorCode::out_of_range,
                 "a plate " + length_text(size.thickness_m) + " thick and " + length_text(shorter) +
                     " wide is too thick; its thickness must be at most half its width, or make a box",
                 "thickness"};
  }
  const Range<double> corners{size.thickness_m, 0.5 * shorter};
  if (!corners.contains(size.corner_m)) {
    return Error{ErrorCode::out_of_range,
                 "corner is " + length_text(size.corner_m) + ", must be from the thickness, " +
                     length_text(corners.low) + ", to half the width, " + length_text(corners.high),
                 "corner"};
  }
  return shape_along(sides, 1, size.corner_m, 0.5 * size.thickness_m);
}

Result<ExactShape> sheet_shape(double x_size_m, double z_size_m) {
  if (Status status = check_size("size along x", x_size_m); !status) return status.error();
  if (Status status = check_size("size along z", z_size_m); !status) return status.error();
  ExactShape shape;
  shape.at = [=](double u, double v) { return Vector3((u - 0.5) * x_size_m, 0.0, (0.5 - v) * z_size_m); };
  return shape;
}

namespace {

Status first_problem(std::initializer_list<Status> all) {
  for (const Status& status : all) {
    if (!status) return status;
  }
  return {};
}

double shortest_side(const CylinderSize& size) {
  return std::min(2.0 * size.radius_m, size.height_m);
}

double shortest_side(const ConeSize& size) {
  const double widest = 2.0 * std::max(size.radius_m, size.top_radius_m);
  const double top = size.top_radius_m > 0.0 ? 2.0 * std::min(size.radius_m, size.top_radius_m) : widest;
  return std::min({widest, top, size.height_m});
}

}  // namespace

double default_rounding_m(const CylinderSize& size) {
  return default_rounding_fraction * shortest_side(size);
}

double default_rounding_m(const ConeSize& size) {
  return default_rounding_fraction * shortest_side(size);
}

Result<ExactShape> sphere_shape(double radius_m) {
  if (Status status = check_size("radius", radius_m); !status) return status.error();
  return revolved_shape(Meridian::half_circle(radius_m));
}

Result<ExactShape> cylinder_shape(const CylinderSize& size) {
  const Status status = first_problem(
      {check_size("radius", size.radius_m), check_size("height", size.height_m),
       check_rounding("rounding", size.rounding_m, shortest_side(size), 0.5 * shortest_side(size))});
  if (!status) return status.error();
  const double r = size.radius_m, h = 0.5 * size.height_m;
  const std::array<MeridianPoint, 4> vertices = {MeridianPoint(0.0, -h), MeridianPoint(r, -h),
                                                 MeridianPoint(r, h), MeridianPoint(0.0, h)};
  const auto meridian =
      Meridian::rounded(vertices, std::array<double, 4>{0.0, size.rounding_m, size.rounding_m, 0.0});
  if (!meridian) return meridian.error();
  return revolved_shape(meridian.value());
}

Result<ExactShape> cone_shape(const ConeSize& size) {
  const bool pointed = size.top_radius_m == 0.0;
  const Status status = first_problem(
      {check_size("radius", size.radius_m), check_size("height", size.height_m),
       pointed ? Status() : check_size("top radius", size.top_radius_m),
       check_rounding("rounding", size.rounding_m, shortest_side(size), 0.5 * shortest_side(size))});
  if (!status) return status.error();
  const double r = size.radius_m, h = 0.5 * size.height_m, rounding = size.rounding_m;
  const MeridianPoint low(0.0, -h), edge(r, -h), top(size.top_radius_m, h), high(0.0, h);
  const auto meridian = pointed ? Meridian::rounded(std::array<MeridianPoint, 3>{low, edge, high},
                                                    std::array<double, 3>{0.0, rounding, rounding})
                                : Meridian::rounded(std::array<MeridianPoint, 4>{low, edge, top, high},
                                                    std::array<double, 4>{0.0, rounding, rounding, 0.0});
  if (!meridian) return meridian.error();
  return revolved_shape(meridian.value());
}

Result<ExactShape> torus_shape(const TorusSize& size) {
  const Status status = first_problem(
      {check_size("ring radius", size.ring_radius_m), check_size("tube radius", size.tube_radius_m)});
  if (!status) return status.error();
  // The hole of the ring must be at least a thousandth as wide as the tube; otherwise the surface almost
  // touches itself.
  if (!(size.ring_radius_m > 1.001 * size.tube_radius_m)) {
    return Error{ErrorCode::out_of_range,
                 "a tube of radius " + length_text(size.tube_radius_m) +
                     " closes the hole of a ring of radius " + length_text(size.ring_radius_m) +
                     "; make the tube thinner or the ring wider",
                 "tube radius"};
  }
  ExactShape shape;
  shape.u.periodic = shape.v.periodic = true;
  shape.at = [size](double u, double v) {
    const double around = 2.0 * std::numbers::pi * u, along = 2.0 * std::numbers::pi * v;
    const double radius = size.ring_radius_m + size.tube_radius_m * std::cos(around);
    return Vector3(radius * std::cos(along), -size.tube_radius_m * std::sin(around),
                   -radius * std::sin(along));
  };
  return shape;
}

namespace {

Result<ExactShape> make_shape(const SphereSize& size) {
  return sphere_shape(size.radius_m);
}
Result<ExactShape> make_shape(const BoxSize& size) {
  return box_shape(size);
}
Result<ExactShape> make_shape(const CylinderSize& size) {
  return cylinder_shape(size);
}
Result<ExactShape> make_shape(const ConeSize& size) {
  return cone_shape(size);
}
Result<ExactShape> make_shape(const PlateSize& size) {
  return plate_shape(size);
}
Result<ExactShape> make_shape(const SheetSize& size) {
  return sheet_shape(size.x_size_m, size.z_size_m);
}
Result<ExactShape> make_shape(const TorusSize& size) {
  return torus_shape(size);
}
Result<ExactShape> make_shape(const BowlSize& size) {
  return bowl_shape(size);
}

double shape_reach(const SphereSize& size) {
  return size.radius_m;
}
// The reach of a convex shape is the smallest radius of its roundings (see reach_m()).
double shape_reach(const BoxSize& size) {
  return size.rounding_m;
}
double shape_reach(const CylinderSize& size) {
  return size.rounding_m;
}
double shape_reach(const ConeSize& size) {
  return size.rounding_m;
}
double shape_reach(const PlateSize& size) {
  return 0.5 * size.thickness_m;
}
double shape_reach(const SheetSize&) {
  return std::numeric_limits<double>::infinity();
}
double shape_reach(const TorusSize& size) {
  return std::min(size.tube_radius_m, size.ring_radius_m - size.tube_radius_m);
}
double shape_reach(const BowlSize& size) {
  return bowl_reach_m(size);
}

}  // namespace

double reach_m(const StockShapeSize& size) {
  return std::visit([](const auto& sizes) { return shape_reach(sizes); }, size);
}

Result<ExactShape> stock_shape(const StockShapeSize& size) {
  return std::visit([](const auto& sizes) { return make_shape(sizes); }, size);
}

int stock_shape_degree(const StockShapeSize& size) {
  const bool is_round = std::holds_alternative<SphereSize>(size) || std::holds_alternative<TorusSize>(size) ||
                        std::holds_alternative<CylinderSize>(size) || std::holds_alternative<ConeSize>(size);
  return is_round ? 5 : 3;
}

double default_tolerance_m(const ExactShape& shape) {
  SPOONBILL_ASSERT(static_cast<bool>(shape.at));
  constexpr int steps = 16;
  Box box;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const auto at = [&](const ShapeDirection& direction, int k) {
        return direction.start() + (direction.end() - direction.start()) * k / steps;
      };
      box.include(shape.at(at(shape.u, i), at(shape.v, j)));
    }
  }
  const Vector3 size = box.extent();
  return std::min(1e-5 * std::max(1.0, size.minCoeff()), 1e-3 * size.maxCoeff());
}

}  // namespace spoonbill
