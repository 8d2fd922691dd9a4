#include "engine/shapes/box_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/number_text.h"
#include "engine/shapes/shape_sizes.h"

namespace spoonbill {

namespace {

// A rectangle with rounded corners about the origin, from the middle of its side at +x on through +y, by
// length.
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

  // From 0 to 1, each where a side meets a corner or begins to be slowed by it.
  std::vector<double> breaks() const {
    std::vector<double> shares = {0.0};
    const auto add = [&](double distance) {
      const double share = distance / length();
      if (share > shares.back() + 1e-9) shares.push_back(share);
    };
    for (std::size_t piece = 0; piece + 1 < ends_.size(); ++piece) {
      const double start = ends_[piece], end = ends_[piece + 1];
      const bool is_side = piece % 2 == 0;
      const bool from_middle = piece == 0, to_middle = piece + 2 == ends_.size();
      if (is_side && !from_middle && end - start > (to_middle ? 1.0 : 2.0) * slowed()) add(start + slowed());
      if (is_side && !to_middle && end - start > (from_middle ? 1.0 : 2.0) * slowed()) add(end - slowed());
      add(end);
    }
    shares.back() = 1.0;
    return shares;
  }

  struct Place {
    Vector2 point, normal;
  };

  // The corners of an outline made smaller are slower than its sides by as much as their arcs are shorter.
  // The sides then reach the corners at that speed, so that a curve through both needs no knots to go on
  // smoothly.
  Place at(double share, double speed_at_corners) const {
    const double distance = share * length();
    const auto after = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, distance);
    const int piece = static_cast<int>(after - ends_.begin()) - 1;
    const double from = ends_[static_cast<std::size_t>(piece)], along = distance - from;
    const double x = half_x_ - rounding_, y = half_y_ - rounding_;
    const auto off_middle = [&](double half_side, double off) {
      return place_on_side(half_side, off, 1.0 - speed_at_corners);
    };
    switch (piece) {
      case 0:
        return {{half_x_, off_middle(y, along)}, Vector2::UnitX()};
      case 2:
        return {{off_middle(x, x - along), half_y_}, Vector2::UnitY()};
      case 4:
        return {{-half_x_, off_middle(y, y - along)}, -Vector2::UnitX()};
      case 6:
        return {{off_middle(x, along - x), -half_y_}, -Vector2::UnitY()};
      case 8:
        return {{half_x_, off_middle(y, along - y)}, Vector2::UnitX()};
      default:
        return corner(piece, along);
    }
  }

 private:
  // Of the outline, on either side of a corner: as much as leaves the lines across the outline straight
  // enough.
  double slowed() const { return 4.0 * rounding_; }

  // Cubic over the whole side, or over what is slowed at its ends.
  double place_on_side(double half_side, double off_middle, double slower) const {
    if (!(half_side > 0.0)) return 0.0;
    if (half_side <= slowed()) {
      const double part = off_middle / half_side;
      return off_middle * (1.0 + 0.5 * slower * (1.0 - part * part));
    }
    const double part = std::min(1.0, (half_side - std::abs(off_middle)) / slowed());
    return off_middle + std::copysign(slower * slowed() * part * (1.0 - part) * (1.0 - part), off_middle);
  }

  Place corner(int piece, double along) const {
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

// A box along its third axis: rings are outlines of its section, rolled over the end edges by an angle and
// then drawn together towards the middle of the end face.
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
    const RoundedRectangle::Place ring = outline_.at(u, 1.0);
    return {ring.point.x(), ring.point.y(), distance - end - half_.z() + rounding_};
  }

 private:
  // The mean way from the pole to the edge, as long as no line then starts backwards from the pole.
  static double face_length(double half_x, double half_y) {
    return std::min(0.5 * (half_x + half_y), 1.6 * std::min(half_x, half_y));
  }

  double whole() const { return 2.0 * (face_ + roll_) + side_; }

  // The share of the way from the pole to the edge, which it reaches as fast as the roll over it begins.
  double drawn_out(double half, double from_pole) const {
    const double speed = face_ / (half - rounding_), share = from_pole / face_;
    return share * (2.0 - speed - (1.0 - speed) * share);
  }

  Vector3 on_end(double u, double from_pole, double end) const {
    const double angle = std::max(0.0, (from_pole - face_) / rounding_);
    const double inwards = rounding_ * (1.0 - std::sin(angle));
    const RoundedRectangle::Place ring = outline_.at(u, 1.0 - inwards / outline_.rounding());
    const Vector2 inner = ring.point - rounding_ * ring.normal;
    if (from_pole < face_) {
      return {drawn_out(half_.x(), from_pole) * inner.x(), drawn_out(half_.y(), from_pole) * inner.y(),
              end * half_.z()};
    }
    const Vector2 point = inner + rounding_ * std::sin(angle) * ring.normal;
    return {point.x(), point.y(), end * (half_.z() - rounding_ * (1.0 - std::cos(angle)))};
  }

  Vector3 half_;
  double rounding_;
  RoundedRectangle outline_;
  double face_, roll_, side_;  // lengths along v
};

// The end faces are to be the squarer ones, so that cells about the poles are not slender; along the longest
// side where that is much the same.
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

double usual_rounding_m(const BoxSize& size) {
  return usual_rounding_share * size.size_m.minCoeff();
}

Result<ExactShape> box_shape(const BoxSize& size) {
  if (Status status = check_sides(size.size_m); !status) return status.error();
  const double shortest = size.size_m.minCoeff();
  const Status status =
      check_rounding("rounding", size.rounding_m, shortest, largest_box_rounding_share * shortest);
  if (!status) return status.error();
  return shape_along(size.size_m, box_axis(size.size_m), std::min(2.0 * size.rounding_m, 0.5 * shortest),
                     size.rounding_m);
}

double usual_corner_m(const PlateSize& size) {
  return std::max(size.thickness_m, usual_rounding_share * std::min(size.x_size_m, size.z_size_m));
}

Result<ExactShape> plate_shape(const PlateSize& size) {
  const Vector3 sides(size.x_size_m, size.thickness_m, size.z_size_m);
  if (Status status = check_sides(sides); !status) return status.error();
  const double shorter = std::min(size.x_size_m, size.z_size_m);
  if (!(2.0 * size.thickness_m <= shorter)) {
    return Error{"a plate " + length_text(size.thickness_m) + " thick and " + length_text(shorter) +
                 " wide is none; make it at most half as thick, or make a box"};
  }
  const Range<double> corners{size.thickness_m, 0.5 * shorter};
  if (!corners.contains(size.corner_m)) {
    return Error{"corner is " + length_text(size.corner_m) + ", must be from the thickness, " +
                 length_text(corners.low) + ", to half the width, " + length_text(corners.high)};
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

}  // namespace spoonbill
