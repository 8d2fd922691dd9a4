// Makes patches that lie one after the other along v fit each other across: one degree, one domain and one
// knot vector along u, seams that lie beside each other, parameters that agree on edges that coincide. Pure
// functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/result.h"

namespace spoonbill {

struct CompatiblePatches {
  std::vector<Surface> patches;
  double deviation_m = 0.0;  // zero but where parameters had to be matched
};

// Edges that are at most `tolerance_m` apart coincide. `degree_v` is the least degree along v. The first
// patch keeps its domain along u; the seam of each ring lies where it fits the ring before best, and `twist`
// of a turn further. Refused: a closed patch beside an open one, parameters that cannot be matched within the
// tolerance.
Result<CompatiblePatches> compatible_along_v(std::vector<Surface> patches, double tolerance_m, int degree_v,
                                             double twist = 0.0);

}  // namespace spoonbill
