// Where a surface folds over, so that its normal points to the other side. Pure functions, outside the tick;
// any thread.
#pragma once

#include <optional>

#include "engine/bspline/surface.h"

namespace spoonbill {

// A place where normals turn by more than a right angle from one cell to the next, of which each polynomial
// piece has four by four; not across an edge, a knot as often as the degree, where two sides may meet at any
// angle.
std::optional<Vector3> place_of_fold(const Surface& surface);

// Of a strip that leads along v from one edge to another, from `start` to `end`: also where its normal points
// against those at both edges though these agree, however slowly it turns there, and where that of the next
// line does though they agree at both edges.
std::optional<Vector3> place_of_fold_between(const Surface& surface, double start, double end);

}  // namespace spoonbill
