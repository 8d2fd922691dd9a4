// Which side of an open surface is out where the data do not tell.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Whether the normals of a sheet, or of a tube (periodic in u), face the wrong way: those of a tube face away
// from its axis, those of a sheet away from its hollow side. What is as good as flat faces +z; upright, +y;
// then +x.
bool faces_inner_side(const Surface& surface);

}  // namespace spoonbill
