// Initial parameters of points in the (u, v) square of a surface that will be fitted to them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

enum class ShapeKind { sheet, tube, closed };

constexpr std::string_view name_of(ShapeKind kind) {
  return kind == ShapeKind::sheet ? "sheet" : kind == ShapeKind::tube ? "tube" : "closed";
}

// Parameters of points. A sheet is open in u and v. A tube is periodic in u with open ends. A closed shape is
// periodic in u with a pole at both ends of v.
struct Parameterisation {
  ShapeKind kind = ShapeKind::sheet;
  std::vector<Vector2> uv;  // parameters of each point, in [0, 1]; NaN where unknown
};

// Detects the kind of shape from its boundary loops. A shape with two loops about as long as its girth is a
// tube. Any other shape is a sheet if the area within its longest loop is more than 30 % of the area of its
// surface, or 12 % if the normals point inwards. Smaller loops are holes of a closed shape.
ShapeKind classify_shape(const FitPoints& island);

// Adds nodes over all holes and open ends, and clears the boundary loops.
void span_all_holes(FitPoints& island);

// Spans the holes with added nodes and computes (u, v) for all nodes. The poles of a closed shape are on its
// axis if the shape is round about an axis, otherwise as far apart as possible. Fails if the shape cannot be
// parameterised as `kind`.
Result<Parameterisation> initial_parameterisation(FitPoints& island, ShapeKind kind);

// Parameterisation of a thin wall about an axis, such as a bowl, cup or plate. Its two faces may be closer
// together than neighbouring points, but the profile of all points together is clear. The angle about the
// axis gives u. The outline of the profile, from the axis over the rim back to the axis, gives v. There is no
// such map if the points are not round about an axis, have no such outline, or are not a thin wall with two
// faces.
struct ProfileMap {
  Parameterisation start;
  bool may_be_one_face;  // true if the points may be a single face whose noise looks like a wall
};
std::optional<ProfileMap> map_profile(const std::vector<Vector3>& points_m);

}  // namespace spoonbill
