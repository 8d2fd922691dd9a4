// How large a surface is.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

// The box about a grid of its points, fine enough to find a size to a thousandth of it; of a trimmed surface
// about what the loops keep. Loops that keep nothing sensible are left out of account.
Box extent_of(const Surface& surface, const std::vector<TrimLoop>& trims = {});

}  // namespace spoonbill
