// The point of a surface that is deepest in a solid, or nearest to it, polished from a point near it.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/collision/solids/tool_shape.h"

namespace spoonbill {

// A point of a surface and the tool's distance from it.
struct SurfaceSpot {
  double u = 0.0, v = 0.0;
  Vector3 point_m = Vector3::Zero();
  double distance_m = 0.0;
};

// Goes down from `from` to a local minimum of the distance over the surface, and never up. Where several
// faces of the solid are as near (an edge, a ridge inside), the faces that it has met are kept, each with its
// second order, and a step makes the largest of them least: a bundle-Newton method (Luksan and Vlcek 1998) in
// two unknowns. The tool must be a solid. Allocates nothing.
SurfaceSpot polished_on_solid(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from);

}  // namespace spoonbill
