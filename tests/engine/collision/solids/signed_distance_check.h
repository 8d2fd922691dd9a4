// Checks by samples that a signed distance satisfies the conditions of signed_distance.h.
#pragma once

#include "engine/base/result.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Samples the box `where`, given in the solid's own frame, which should enclose the solid. The samples are
// the same in each call. Returns an Error for the first condition that fails:
//   - the distance and gradient are finite, and the gradient has unit length;
//   - the distance changes by no more than the point moves;
//   - inside points are within the bounds;
//   - no tangent is above the distance, if the solid claims to be convex; otherwise, no tangent is above it
//     by more than the solid's concavity() permits;
//   - the gradient agrees with differences of the distance, except at a fiftieth of the samples, which may
//     be at kinks.
// The check is too slow for a tick.
Status check_signed_distance(const SignedDistance& solid, const Box& where);

}  // namespace spoonbill
