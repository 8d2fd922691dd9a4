// An independent, slow answer to whether a surface passes through itself: the triangles between dense
// samples.
#pragma once

#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Each finest cell of the grid is cut into `parts` by `parts`. Triangles of cells that have a corner in
// common, across a periodic seam too, are not compared.
bool samples_cross(const Surface& surface, const NestedGrid& nested, int parts);

}  // namespace spoonbill
