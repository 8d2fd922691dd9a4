// Lower bounds of a tool's distance over boxes and over patches of a surface.
#pragma once

#include "engine/base/geometry.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/tool_shape.h"

namespace spoonbill {

double lower_bound(const ToolShape& tool, const Box& box);

// Over a patch that leaves the bilinear patch of its corners by at most `bulge`. Where the bound is at least
// `enough`, a better one is not searched for.
double lower_bound(const ToolShape& tool, const PatchCorners& corners, double bulge, double enough);

// How far the tool is behind the plane through `point` with the unit normal `normal`, at its farthest: the
// way along the normal that takes it out. Infinite where the tool is endless. Exact to 1e-5 of the tool's
// size.
double depth_behind(const ToolShape& tool, const Vector3& point, const Vector3& normal);

}  // namespace spoonbill
