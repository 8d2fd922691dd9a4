// A closed body over other parameters, whose poles lie where they are wanted. Outside the tick; pure
// function.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/result.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

// v starts at the pole that lies in the unit direction from the body's middle, and ends at the opposite one;
// u runs around so that normals still point outwards. Fitted to the body within the tolerance. Refused: a
// body that is not a tube with two poles, or not seen as a whole from its middle.
Result<FittedShape> with_pole_towards(const Surface& body, const Vector3& direction, double tolerance_m);

// The middle of a closed body: the mean of its rings' middles.
Vector3 middle_of(const Surface& body);

}  // namespace spoonbill
