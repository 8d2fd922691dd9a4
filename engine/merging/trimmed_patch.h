// A trimmed patch as a whole one: resampled along its lines of constant u from trim to trim, and fitted.
// Outside the tick; pure function.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

// What the loops keep, its edges in v on the trims, u ending where the kept part does; C0 along lines through
// corners of the trims, which are taken as their polygons (to_polygon). Lines of constant u must each meet
// the kept part in one piece; where they do not, lines of constant v are tried, then lines towards the middle
// of a disc or of a hole (round_part.h). Without loops the surface itself. Refused: holes and other parts
// that none cuts into single pieces, a part that ends in a point where no line is left of it.
Result<FittedShape> untrimmed(const Surface& surface, const std::vector<TrimLoop>& trims, double tolerance_m);

}  // namespace spoonbill
