// The same surface run through otherwise: backwards, with u and v exchanged, from another seam, over another
// domain. Exact; pure functions, any thread.
#pragma once

#include "engine/bspline/change_knots.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Run through from the end to the start. Turns the normals.
Surface reversed(const Surface& surface, Direction direction);

// u becomes v and v becomes u. Turns the normals.
Surface exchanged(const Surface& surface);

// Over the domain [start, end]. Refused unless start < end, both finite.
Result<Surface> with_domain(const Surface& surface, Direction direction, double start, double end);

// A periodic direction's period starts where it had the parameter `seam` (wrapped into the domain), and keeps
// its domain. A knot is inserted there where none stands. Refused for an open direction.
Result<Surface> with_seam_at(const Surface& surface, Direction direction, double seam);

// From `start` to `end`, clamped; of a periodic direction also across its seam, where `end` is at most one
// period beyond `start`. Refused: a part that is empty or outside the domain.
Result<Surface> part_of(const Surface& surface, Direction direction, double start, double end);

}  // namespace spoonbill
