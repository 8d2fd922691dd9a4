// Takes one knot out of a surface. Pure function, outside the tick; any thread.
#pragma once

#include "engine/bspline/change_knots.h"

namespace spoonbill {

// Without so many copies of the knot that stands at the parameter, by least squares; exact where the surface
// is smooth enough there. Refused: a parameter at which no knot stands, more copies than stand there, the
// ends of an open direction, all copies at the seam of a closed one.
Result<Approximation> without_knot(const Surface& surface, Direction direction, double parameter, int copies);

}  // namespace spoonbill
