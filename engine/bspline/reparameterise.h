// Exact changes of a surface's parameters: inserting knots, reversing a direction, exchanging u and v, moving
// the seam, changing the domain, cutting out a part. All functions are pure; any thread may call them.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Inserts `knot` until it has the given multiplicity (1..degree) in the direction (Boehm 1980); does nothing
// if the surface's knot already has this multiplicity or a higher one. In an open direction the knot must be
// strictly inside the domain; in a periodic direction it is wrapped into the domain.
Result<Surface> insert_knot(const Surface& surface, Direction direction, double knot, int multiplicity);

// Returns the surface with a direction reversed, which flips the normals.
Surface reversed(const Surface& surface, Direction direction);

// Returns the surface with u and v exchanged, which flips the normals.
Surface exchanged(const Surface& surface);

// Returns the same surface with the direction's parameters rescaled to the domain [start, end]. Refuses ends
// that are not finite or not increasing.
Result<Surface> with_domain(const Surface& surface, Direction direction, double start, double end);

// Returns the surface with the seam of a periodic direction at the parameter `seam` (wrapped into the
// domain); the domain stays the same. If no knot is there, one is inserted. Refuses an open direction.
Result<Surface> with_seam_at(const Surface& surface, Direction direction, double seam);

// Returns the part of the surface from `start` to `end`, with clamped knots. In a periodic direction the part
// may cross the seam, with `end` at most one period beyond `start`. Refuses a part that is empty or outside
// the domain.
Result<Surface> part_of(const Surface& surface, Direction direction, double start, double end);

}  // namespace spoonbill
