// Makes patches that lie one after the other along v fit each other across: one degree, one domain and one
// knot vector along u, seams that lie beside each other, parameters that agree on edges that coincide. Pure
// functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/join_request.h"

namespace spoonbill {

struct CompatiblePatches {
  std::vector<Surface> patches;
  double deviation_m = 0.0;  // zero but where parameters had to be matched or knots brought together
};

// Edges that are at most the tolerance apart coincide, wherever their parameters are. The degree along v is
// at least one more than the continuity. The first patch keeps its domain along u; the seam of each ring lies
// beside that of the ring before where they coincide, else where it fits that best, and the twist further.
// Refused: a closed patch beside an open one, parameters that cannot be matched within the tolerance, more
// than the largest count of control points.
Result<CompatiblePatches> compatible_along_v(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
