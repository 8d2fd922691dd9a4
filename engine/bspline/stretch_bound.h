// How far a point of a surface moves at most for a step over its parameters. Pure; any thread.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// In metres, for a step of the length of the domain: one of shares a and b of it along u and v, of the length
// hypot(a, b), moves a point by no more than a of the longest derivative along u and b of that along v
// (derivative_bound.h).
double longest_stretch_m(const Surface& surface);

}  // namespace spoonbill
