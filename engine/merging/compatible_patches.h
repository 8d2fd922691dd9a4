// Makes consecutive patches of a row compatible along u: one degree, domain and knot vector, adjacent seams,
// equal parameters on shared edges. The functions have no side effects, may run on any thread, and are too
// slow for a tick.
#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

struct JoinRequest {
  int continuity = 2;         // order of continuity at the joints, 0 to 8
  double tolerance_m = 5e-5;  // largest distance of the merged surface from the patches, outside blends
  // Part of the tolerance that earlier steps have used or that is reserved for later steps.
  double spent_m = 0.0;
  double blend_m = 0.0;            // length of a blend at joints that lack the continuity; 0 for none
  double twist = 0.0;              // rotation of each ring from its best fit, as a fraction of a turn
  int largest_count = 200;         // largest number of control points in each direction
  bool shared_parameters = false;  // true: edges already agree in parameters and seams
  bool bridges_may_fold = false;   // true: a bridge that folds is not refused
  Progress progress = {};          // progress of the whole request
};

// Largest distance of knots that are snapped together, as a fraction of the domain. They are snapped only if
// that changes the surface little.
inline constexpr double snap_fraction = 1e-5;

// Returns the seam of the second ring, moved by at most `snap_fraction` of the period so that a knot of the
// second ring coincides with the first ring's seam. If there is no such knot, the closest pair of knots is
// made to coincide, if the same limit permits. Both periods must have the same length.
double align_seam_to_knots(const KnotVector& first, const KnotVector& second, double seam);

struct SnappedKnots {
  Surface surface;
  double deviation_m = 0.0;  // deviation from the original surface at equal parameters
};

// Snaps the surface's knots along u to the knots in `knots` that they nearly equal. Both must have the same
// domain. Returns the surface unchanged if the deviation would exceed `most_m`. The first and the last knot
// are not moved.
SnappedKnots snap_knots(const Surface& surface, const KnotVector& knots, double most_m);

struct CompatiblePatches {
  std::vector<Surface> patches;
  double deviation_m = 0.0;  // greater than 0 only if parameters were matched or knots snapped
};

// Makes the patches compatible along u. Edges within three quarters of the tolerance count as shared,
// whatever their parameters. The degree along v becomes at least the continuity plus one. The first patch
// keeps its u domain. The seam of a ring is placed next to the previous ring's seam or at the best fit, and
// then rotated by the twist. Fails for a closed patch next to an open one, for parameters that cannot be
// matched within the tolerance, and if too many control points are needed.
Result<CompatiblePatches> make_compatible(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
