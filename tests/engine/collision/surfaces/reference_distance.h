// An independent, slow bound for the distance of two surfaces: dense samples, and how far any point can be
// from the nearest sample.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

struct DistanceBounds {
  double low_m, high_m;
};

// Returns bounds that enclose the distance. Each piece of a surface, with sides h_u and h_v, is in a ball of
// radius (h_u L_u + h_v L_v) / 2 around its centre, where L_u and L_v are the largest derivatives. Pairs of
// balls are halved until the bounds agree to the fraction `share`, or the distance is below `enough_m`.
DistanceBounds reference_distance(const Surface& first, const Surface& second, double share, double enough_m);

}  // namespace spoonbill
