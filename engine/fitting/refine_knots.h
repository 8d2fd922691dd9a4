// Where further knots serve a fit most.
#pragma once

#include <span>

#include "engine/bspline/knot_vector.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {

// Halves the spans of the direction (0: u, 1: v) over which the weighted squares of errors sum to most, one
// after another, until the knots have `count` control points. A span that is halved shares its sum; what is
// error throughout spreads evenly, as every span counts for a share of the mean besides. Spans shorter than
// an eighth of the mean are left.
KnotVector with_knots_for_errors(const KnotVector& knots, int direction, int count,
                                 std::span<const Vector2> uv, std::span<const double> weighted_squares);

}  // namespace spoonbill
