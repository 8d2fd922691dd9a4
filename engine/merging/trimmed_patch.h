// Resampling of trimmed patches as patches without trims. The functions have no side effects and are too slow
// for a tick.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

// Resamples the part between a smooth outer loop and its centroid or a smooth hole. `polygons` are loops in
// the parameter plane, with the kept part on their left. The result is periodic in u, which is proportional
// to the distance along the outer loop, measured in space. The lines along v are straight in the old
// parameters. They run towards the centroid of the hole and end at the edge of the hole. Without a hole they
// end in a pole at the centroid of the outer loop. Returns nothing if there are more than two loops, a loop
// has corners, or a line from the centroid meets a loop more than once. Fails if fit_shape() fails.
std::optional<Result<FittedShape>> resample_round_part(
    const Surface& surface, const std::vector<std::vector<Eigen::Vector2d>>& polygons, double tolerance_m);

// Resamples the part inside the loops; without loops, returns the surface itself. The edges of the result at
// both ends of v follow the trims, as polygons (to_polygon()). At the corners of the trims, the result is
// only C0 across a line of constant u. The part must meet each line of constant u in a single interval.
// Otherwise lines of constant v are tried, and then lines towards the centre of a disc or hole. Fails if none
// of these work, or if the part ends in a point.
Result<FittedShape> untrimmed(const Surface& surface, const std::vector<TrimLoop>& trims, double tolerance_m);

}  // namespace spoonbill
