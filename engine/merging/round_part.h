// A trimmed patch about a centre, such as a disc or a ring, as a whole patch that runs around it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

// The part of a surface between a round outer edge and a point within it, or a round hole: `polygons` over
// its parameters, what is kept on their left. The result is periodic along u, which runs along the outer edge
// by its length in metres; v runs on straight lines of the parameters from there to the hole, or to a pole at
// the centroid. Lines are straight towards the hole's centroid. None where the part is not of that kind:
// other than one or two edges, an edge with corners, or one that a line from the centre meets more than once.
// Refused: what fit_shape() refuses. Outside the tick; pure function.
std::optional<Result<FittedShape>> round_part(const Surface& surface,
                                              const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                              double tolerance_m);

}  // namespace spoonbill
