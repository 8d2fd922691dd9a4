// One body over the gaps between islands.
#pragma once

#include <vector>

#include "engine/fitting/fit_points.h"
#include "engine/result.h"

namespace spoonbill {

// Spans the holes of each island, opens each where it comes nearest to the others, and spans the gaps by
// straight tubes of nodes. The first island is the largest; each further one joins whichever is nearest to
// it. Refused: an island too small to open.
Result<FitPoints> bridged(std::vector<FitPoints> islands);

}  // namespace spoonbill
