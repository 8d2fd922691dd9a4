// How large a surface is.
#pragma once

#include "engine/box.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// The box about a grid of its points, fine enough to find a size to a thousandth of it.
Box extent_of(const Surface& surface);

}  // namespace spoonbill
