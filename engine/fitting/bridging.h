// Bridges that join the connected components of a scan into one closed body.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/fit_points.h"

namespace spoonbill {

// Joins all components into one. Holes are spanned, each component is opened where it is nearest to the
// others, and straight tubes of nodes span the gaps. The first component must be the largest, and every other
// component is joined to the component nearest to it. Other open ends are capped. Fails if a component is too
// small to be opened.
Result<FitPoints> bridge_islands(std::vector<FitPoints> islands);

// Returns the number of components that have an open end away from the gaps, which are sheets or open tubes.
// bridge_islands() caps such ends.
std::size_t count_open_islands(const std::vector<FitPoints>& islands);

}  // namespace spoonbill
