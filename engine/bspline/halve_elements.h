// Halving of elements that are too long. Exact: no point of the surface moves.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Halves the elements that are longer than `longest_m` in a direction, until none is or until another halving
// of all of them would give more than `most_control_points`, or more than `most_in_direction` along u or v.
// An element is as long as the chords over its two halves where these are longest.
Result<Surface> halve_long_elements(Surface surface, double longest_m, int most_control_points,
                                    int most_in_direction);

}  // namespace spoonbill
