// Knots that two patches have in common but for rounding and noise: brought together, for each pair that is
// left apart would become a sliver between two knots of the merged surface. Pure functions, outside the tick;
// any thread.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Knots nearer to each other than this share of the domain are brought together where that costs little.
inline constexpr double nearly_same_share = 1e-5;

// The seam moved by less than that, so that a knot of the second ring comes to lie on the seam of the first
// or, where none is near it, the nearest pair of their knots on each other. Both periods are of one length.
double seam_at_nearly_same_knots(const KnotVector& first, const KnotVector& second, double seam);

struct MovedKnots {
  Surface surface;
  double deviation_m = 0.0;  // to the surface as it was, at its parameters
};

// The surface with those knots along u moved that nearly are one of `knots`, over the same domain; as it was
// where that costs more than `most_m`. Ends, and knots of which another is that one already, stay.
MovedKnots with_nearly_same_knots(const Surface& surface, const KnotVector& knots, double most_m);

}  // namespace spoonbill
