// Exact knot insertion: more control points, the same surface (Boehm 1980).
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

enum class Direction { u, v };

// Inserts `knot` until it has the given multiplicity (1..degree) in that direction. Does nothing when it
// already has. The knot must lie strictly inside the domain (anywhere in the period when periodic).
Result<Surface> insert_knot(const Surface& surface, Direction direction, double knot, int multiplicity);

}  // namespace spoonbill
