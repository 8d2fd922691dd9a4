// Ends of tubes: closing seams, capping open rings, and opening poles so that another tube can be joined. A
// tube is periodic in one direction and open in the other. The functions have no side effects, may run on any
// thread, and are too slow for a tick.
#pragma once

#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/surface.h"
#include "engine/merging/join_row.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

// Makes a direction periodic if its first and last edge meet. The seam has the given continuity; the degree
// is raised if needed. The result is exact if the derivatives agree at the seam. Otherwise knots are added
// beside the seam until the tolerance is met. Fails for a periodic direction, or for edges farther apart than
// the tolerance. Can be stopped.
Result<Approximation> close_around(const Surface& surface, Direction direction, int continuity,
                                   double tolerance_m, const Progress& progress = {});

bool is_tube(const Surface& surface);

// Returns the sides at the two ends of a tube.
std::pair<Side, Side> tube_sides(const Surface& surface);

bool is_pole(const Surface& surface, Side side);

// Centre and mean radius of a tube's end (radius 0 at a pole), and the unit direction out of the tube.
struct TubeEnd {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 outward = Vector3::Zero();
};
TubeEnd tube_end(const Surface& surface, Side side);

// Closes an open end, whose ring must be nearly plane, with a cap of height `height_m`. A cap with a height
// above zero continues the sides with the requested continuity, as a quarter ellipse: the cubic with the
// ellipse's tangents and midpoint (Goldapp 1991). A cap of height zero is flat and meets the sides at an
// edge. Fails if a flat cap would fold because part of the ring is not visible from the ring's centre.
Result<Joined> add_cap(const Surface& surface, Side side, double height_m, const JoinRequest& request);

// Cuts off a pole so that the tube ends in a ring. The cut is where the radius grows by less than 0.1 of the
// distance along the axis, or earlier where the ring is as wide as `wide_enough_m`. Fails if half of the tube
// would be lost.
Result<Surface> open_pole(const Surface& surface, Side side, double wide_enough_m);

// Returns pairs of ends that connect the tubes, the nearest first. Each end is used once. Among pairs that
// are equally near, those of similar width come first.
std::vector<std::pair<PatchEdge, PatchEdge>> find_nearest_ends(const std::vector<Surface>& tubes);

}  // namespace spoonbill
