// Independent, slow bounds on the distance between two surfaces, from dense samples and from how far any
// point can be from the nearest sample.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

struct DistanceBounds {
  double low_m, high_m;
};

// Returns bounds that enclose the distance. Each piece of a surface, with sides h_u and h_v, is in a ball of
// radius (h_u L_u + h_v L_v) / 2 around its centre, where L_u and L_v are the largest derivatives. In the
// nearest pair of balls, the piece with the larger ball is halved, until the bounds agree to within the
// fraction `share` or the upper bound is at most `enough_m`.
DistanceBounds reference_distance(const Surface& first, const Surface& second, double share, double enough_m);

}  // namespace spoonbill
