// Bridges that join the connected components of a scan into one closed body.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/fit_points.h"

namespace spoonbill {

// Joins all components into one. Holes are spanned, components are opened where they are nearest to each
// other, and straight tubes of nodes span the gaps. The first component must be the largest. Each step adds
// the component that is nearest to the joined ones. Other open ends are capped. Fails if a component is too
// small to be opened.
Result<FitPoints> bridge_islands(std::vector<FitPoints> islands);

// Returns the number of components that are sheets or open tubes and have an open end away from all other
// components. bridge_islands() caps such ends.
std::size_t count_open_islands(const std::vector<FitPoints>& islands);

}  // namespace spoonbill
