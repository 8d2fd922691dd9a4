// One body over the gaps between islands.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/fit_points.h"

namespace spoonbill {

// Spans the holes of each island, opens each where it comes nearest to the others, and spans the gaps by
// straight tubes of nodes. The first island is the largest; each further one joins whichever is nearest to
// it. What is open besides is capped. Refused: an island too small to open.
Result<FitPoints> bridged(std::vector<FitPoints> islands);

// How many of the islands are sheets or tubes that are open elsewhere than where they face each other:
// bridged, they are capped there.
std::size_t open_beside_gaps(const std::vector<FitPoints>& islands);

}  // namespace spoonbill
