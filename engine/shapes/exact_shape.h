// Exact shapes: functions of two parameters to which surfaces are fitted. Also their derivatives, distances
// to points, and checks of their sizes.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// One direction of a shape's parameters. `breaks` increase from one end of the domain to the other. The shape
// is smooth between successive breaks, and a fit puts a knot at each break.
struct ShapeDirection {
  bool periodic = false;
  std::vector<double> breaks{0.0, 1.0};

  double start() const { return breaks.front(); }
  double end() const { return breaks.back(); }
};

// A shape whose points are in metres and whose du x dv points outwards. `at` is called with parameters within
// the domain and must be continuous there. A fit is best if equal steps of a parameter cover about equal
// distances everywhere.
struct ExactShape {
  ShapeDirection u, v;
  // True if the shape has a pole (one point for all u) at the start or the end of v.
  bool pole_at_start = false, pole_at_end = false;
  // Flat ends of a shape with poles. The shape is flat for v from the start of the domain to `flat_to`, and
  // from `flat_from` to the end of the domain. Each value must be one of `v.breaks`; it is empty if that end
  // is not flat.
  std::optional<double> flat_to = {}, flat_from = {};
  std::vector<Vector2> rim = {};  // corners of a bowl's rim, as (u, v) (Body::rim); empty for other shapes
  std::function<Vector3(double u, double v)> at;

  bool is_closed() const { return u.periodic && (v.periodic || (pole_at_start && pole_at_end)); }
};

// Tangents and unit normal of a shape by finite differences, which are one-sided at the ends of an open
// direction. The normal is zero if the tangents are parallel, as at a pole.
struct ShapeTangents {
  Vector3 du, dv;
  Vector3 normal = Vector3::Zero();
};
ShapeTangents tangents(const ExactShape& shape, double u, double v);

// Returns an upper bound of the distance from a point to the shape: the distance to a point of the shape that
// is found by Gauss-Newton steps from (u, v).
double distance_near(const ExactShape& shape, const Vector3& point_m, double u, double v);

// Returns the unit normal at the pole at the start or the end of v; nullopt if the shape has no tangent plane
// there.
std::optional<Vector3> pole_normal(const ExactShape& shape, bool at_start);

// Range of the sizes of stock shapes.
inline constexpr Range<double> shape_size_range_m{1e-4, 10.0};
// Smallest radius of a rounded edge, as a fraction of the shortest side of the shape. Sharper edges would
// need more control points than a fit may use.
inline constexpr double min_rounding_fraction = 0.01;
// Default radius of a rounded edge, as a fraction of the shortest side of the shape.
inline constexpr double default_rounding_fraction = 0.1;

// Returns an out_of_range error unless the length is within the range. The message is in millimetres, such as
// "radius is 0.01 mm, must be from 0.1 mm to 10000 mm".
Status check_length(std::string_view name, double length_m, Range<double> range_m);
// Returns an error unless the size is within shape_size_range_m.
Status check_size(std::string_view name, double size_m);
// Returns an error unless the rounding is at least min_rounding_fraction of `side_m` and at most `max_m`.
Status check_rounding(std::string_view name, double rounding_m, double side_m, double max_m);

}  // namespace spoonbill
