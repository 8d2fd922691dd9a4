// Whether the convex hulls of two control nets are apart: then the surfaces are too. By the support function
// alone, the farthest control point along a direction, so that hulls follow the moving control points without
// being built (Gilbert, Johnson and Keerthi 1988). Allocates nothing.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// True only with a plane between the hulls, checked against all control points; hulls that nearly touch may
// count as meeting.
bool hulls_are_apart(const ControlNet& first, const ControlNet& second);

}  // namespace spoonbill
