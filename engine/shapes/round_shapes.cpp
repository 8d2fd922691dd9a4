#include "engine/shapes/round_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "engine/base/number_text.h"
#include "engine/shapes/meridian.h"
#include "engine/shapes/shape_sizes.h"

namespace spoonbill {

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

double usual_rounding_m(const CylinderSize& size) {
  return usual_rounding_share * shortest_side(size);
}

double usual_rounding_m(const ConeSize& size) {
  return usual_rounding_share * shortest_side(size);
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
  // A thousandth of the tube open in the middle: nearer, the surface all but touches itself.
  if (!(size.ring_radius_m > 1.001 * size.tube_radius_m)) {
    return Error{"a tube of radius " + length_text(size.tube_radius_m) +
                 " closes the hole of a ring of radius " + length_text(size.ring_radius_m) +
                 "; make the tube thinner or the ring wider"};
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

}  // namespace spoonbill
