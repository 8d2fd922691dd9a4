// Exact changes of a surface's parameters: inserting knots, reversing a direction, exchanging u and v, moving
// the seam, changing the domain, cutting out a part. Pure functions; any thread may call them.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Inserts `knot` until it has the given multiplicity (1..degree) in that direction; does nothing if it has at
// least that multiplicity (Boehm 1980). The knot must be strictly inside the domain, or anywhere in the
// period of a periodic direction.
Result<Surface> insert_knot(const Surface& surface, Direction direction, double knot, int multiplicity);

// Returns the surface with a direction reversed; its normals are flipped.
Surface reversed(const Surface& surface, Direction direction);

// Returns the surface with u and v exchanged; its normals are flipped.
Surface exchanged(const Surface& surface);

// Returns the surface over the domain [start, end]. Refuses ends that are not finite or not increasing.
Result<Surface> with_domain(const Surface& surface, Direction direction, double start, double end);

// Returns the surface with the seam of a periodic direction at the parameter `seam` (wrapped into the
// domain); the domain stays the same. If no knot is there, one is inserted. Refuses an open direction.
Result<Surface> with_seam_at(const Surface& surface, Direction direction, double seam);

// Returns the clamped part from `start` to `end`. In a periodic direction it may cross the seam, with `end`
// at most one period beyond `start`. Refuses an empty part and one outside the domain.
Result<Surface> part_of(const Surface& surface, Direction direction, double start, double end);

}  // namespace spoonbill
