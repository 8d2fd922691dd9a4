// A profile turned about the y axis: a starting shape.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/meridian.h"

namespace spoonbill {

// Through the points in their order, as radius and height. An end on the axis becomes a pole, where the
// profile is level; with both ends there the shape is closed. A profile whose last point is its first, off
// the axis, makes a ring that is closed both ways. Any other is open and its outside is away from the axis.
// Refused: points too few or in one place, radii below 0, a profile that crosses the axis or itself.
Result<ExactShape> lathe_shape(const std::vector<MeridianPoint>& profile_m);

}  // namespace spoonbill
