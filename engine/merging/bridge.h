// The strip that leads from one patch to the next where they do not meet: it continues both with the
// continuity that is asked. Pure functions, outside the tick; any thread.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// How long the strip's parameter along v must be, and by what factor `after`'s domain must be stretched, for
// both patches to run across the gap at one speed: derived from the chords from edge to edge and the mean
// derivatives there. The strip is made tauter where it would fold over, which it does where the chords are
// short or lie askew; and between rings, down to a quarter, until it is nowhere narrower than both of them.
// Refused: edges without a direction across, and strips that fold however taut, unless they may.
struct BridgeLength {
  double parameter = 0.0;
  double stretch_of_after = 1.0;
  double chord_m = 0.0;  // the mean distance of the edges
};
Result<BridgeLength> bridge_length(const Surface& before, const Surface& after, int continuity,
                                   bool may_fold = false);

// From before's end along v to after's start, over [before's end, after's start] as its domain; both of one
// degree and one knot vector along u. Of the patches' degree along v: as many pieces as the continuity needs,
// whose outer control points are those of the patches' last pieces continued; between rings that do not face
// each other, or lie farther apart than twice both their radii, also those of a bend, which keeps the tube
// open and even. Refused: a gap that is empty.
Result<Surface> bridge(const Surface& before, const Surface& after, int continuity);

}  // namespace spoonbill
