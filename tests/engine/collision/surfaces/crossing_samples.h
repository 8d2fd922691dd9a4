// An independent, slow test of whether a surface intersects itself, by triangles between dense samples.
#pragma once

#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Returns true if triangles between dense samples intersect. Each finest cell of the grid is divided into
// `parts` by `parts`. Triangles of cells that share a corner, also across a periodic seam, are not compared.
bool samples_cross(const Surface& surface, const NestedGrid& nested, int parts);

}  // namespace spoonbill
