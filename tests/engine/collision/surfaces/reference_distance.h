// An independent, slow answer to how far two surfaces are apart: dense samples with a bound on how far any
// point can be from the nearest of them.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

struct DistanceBounds {
  double low_m, high_m;
};

// The distance lies between both. Each piece is a ball around the middle of a patch of sides h_u, h_v, whose
// radius (h_u L_u + h_v L_v) / 2 follows from the longest derivatives; pairs of balls are halved until the
// bounds are within `share` of each other, or the distance is below `enough_m`.
DistanceBounds reference_distance(const Surface& first, const Surface& second, double share, double enough_m);

}  // namespace spoonbill
