// Contact of a tool with a surface: its position, frame and depth. Also the local search for the surface's
// deepest point in a solid.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/tool_shape.h"

namespace spoonbill {

// A point of a surface, and its signed distance from the tool.
struct SurfaceSpot {
  double u = 0.0, v = 0.0;
  Vector3 point_m = Vector3::Zero();
  double distance_m = 0.0;
};

// Descends from `from` to a local minimum of the distance over the surface. The result is never farther from
// the solid than `from`. If several faces of the solid are equally near (at an edge, or on an inner ridge),
// the second-order expansion of each face is kept. Each step minimises the maximum of these expansions: a
// bundle-Newton method (Luksan and Vlcek 1998) in two unknowns. The tool must be a solid. Allocates nothing.
SurfaceSpot polish_on_solid(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from);

// Unit tangents that span the plane perpendicular to a unit normal: the direction of du projected onto this
// plane, and normal x u. Where du vanishes, as at a pole, dv replaces it. If dv vanishes too, u is any
// direction in the plane.
struct Tangents {
  Vector3 u = Vector3::UnitX(), v = Vector3::UnitZ();
};
Tangents tangents_across(const Vector3& normal, const SurfacePoint& at);

// Position, frame and depth of a contact on a surface.
struct SurfaceContact {
  double u = 0.0, v = 0.0;
  Vector3 point_m = Vector3::Zero();  // point on the surface
  Vector3 normal = Vector3::UnitY();  // unit normal along du x dv
  double depth_m = 0.0;               // depth of the contact; negative if the tool and the surface are apart
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();  // tangents_across() of the normal
};

// A connected part of the surface that a tool touches.
struct ToolContactRegion {
  ParameterRange range;  // parameter rectangle that contains the region
  SurfaceContact deepest;
};

inline constexpr int tool_region_capacity = 64;

// Makes the contact at a point of a surface. Its depth is the negative of the point's distance from the tool.
SurfaceContact contact_at(const Surface& surface, const SurfaceSpot& spot);

}  // namespace spoonbill
