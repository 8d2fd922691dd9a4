// Any smooth patch as a B-spline surface within a tolerance: interpolated at the Greville parameters, with
// more control points wherever the error asks for them.
#pragma once

#include <functional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A break between two smooth pieces, across which derivatives up to this order agree.
struct PatchBreak {
  double parameter;
  int continuity;
};

struct PatchDirection {
  std::vector<PatchBreak> breaks;  // increasing, both ends of the domain included
  // The end meets the start, with the first break's continuity; the result is periodic then.
  bool closed = false;
};

struct Patch {
  PatchDirection u, v;
  std::function<Vector3(double u, double v)> at;  // metres
};

struct PatchFit {
  Surface surface;  // over the patch's own parameters
  // The largest distance at equal parameters over nine places of each of its pieces, each way.
  double deviation_m = 0.0;
};

// Cubic where that is enough, of degree 5 or 7 where fewer control points then do. Refused: a tolerance that
// would take more control points than a surface has, a patch that is not finite.
Result<PatchFit> approximate(const Patch& patch, double tolerance_m);

}  // namespace spoonbill
