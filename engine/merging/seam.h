// Closes a patch around whose first and last edge meet. Pure function, outside the tick; any thread.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A periodic direction with the continuity asked at its seam, whose degree is raised where that takes more:
// exact where derivatives agree there, else fitted with knots added beside the seam until the tolerance
// holds. Refused: a direction that is closed already, edges that are more than the tolerance apart. Stopped
// by the progress.
Result<Approximation> closed_around(const Surface& surface, Direction direction, int continuity,
                                    double tolerance_m, const Progress& progress = {});

}  // namespace spoonbill
