// Checks by samples that a signed distance satisfies the conditions of signed_distance.h.
#pragma once

#include "engine/base/result.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Samples the box `where` in the solid's own frame; it should enclose the solid. The samples are the same
// each time. Returns an Error for the first condition that fails:
//   - the distance and gradient are finite, and the gradient has unit length;
//   - the distance changes by no more than the point moves;
//   - inside points are within the bounds;
//   - a solid that claims to be convex has no tangent above its distance, or satisfies its stated concavity;
//   - the gradient fits differences of the distance in all but a fiftieth of the samples (there are kinks).
// Not for the tick.
Status check_signed_distance(const SignedDistance& solid, const Box& where);

}  // namespace spoonbill
