// Whether a signed distance keeps what signed_distance.h promises, as far as samples can tell.
#pragma once

#include "engine/base/result.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Samples `where`, which should reach around the solid, in the solid's own frame; the same samples every
// time. Refused, by the first that fails: a distance or gradient that is not finite, a gradient that is not
// of unit length, a distance that changes by more than the way moved, a point inside the solid but outside
// its bounds, a solid that says it is convex and has a tangent above its distance (or one that fails its
// stated concavity), and a gradient that does not fit the distance's differences in more than a fiftieth of
// the samples: the few are its kinks. Not for the tick.
Status check_signed_distance(const SignedDistance& solid, const Box& where);

}  // namespace spoonbill
