// Makes consecutive patches of a row compatible along u: one degree, domain and knot vector, adjacent seams,
// equal parameters on shared edges. Pure functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

struct JoinRequest {
  int continuity = 2;         // 0 to 8
  double tolerance_m = 5e-5;  // largest distance of the merged surface from the patches, outside blends
  double spent_m = 0.0;       // part of the tolerance used up by earlier steps or reserved for later steps
  double blend_m = 0.0;       // length of a blend at joints that lack the continuity; 0: none
  double twist = 0.0;         // rotation of each ring from its best fit, as a fraction of a turn
  int largest_count = 200;    // most control points in each direction
  bool shared_parameters = false;  // edges are known to correspond; seams are not searched
  bool bridges_may_fold = false;   // for edges that the user pairs against their best fit
  Progress progress = {};          // progress of the whole request
};

// Knots closer than this fraction of the domain are snapped together if that changes the surface little.
inline constexpr double snap_fraction = 1e-5;

// Returns the seam moved by at most `snap_fraction` of the period, so that a knot of the second ring
// coincides with the first ring's seam. Failing that, the closest pair of knots coincides. Both periods must
// have the same length.
double align_seam_to_knots(const KnotVector& first, const KnotVector& second, double seam);

struct SnappedKnots {
  Surface surface;
  double deviation_m = 0.0;  // from the original surface, at equal parameters
};

// Snaps the knots along u that nearly equal one of `knots`, which must have the same domain. Returns the
// surface unchanged if the deviation would exceed `most_m`. End knots and knots with an exact counterpart
// nearby stay.
SnappedKnots snap_knots(const Surface& surface, const KnotVector& knots, double most_m);

struct CompatiblePatches {
  std::vector<Surface> patches;
  double deviation_m = 0.0;  // non-zero only if parameters were matched or knots snapped
};

// Makes the patches compatible along u. Edges within the tolerance count as shared, whatever their
// parameters. The degree along v becomes at least the continuity plus one. The first patch keeps its u
// domain. Seams of rings are placed next to the previous ring's seam, or at the best fit, plus the twist.
// Fails for a closed patch next to an open one, parameters that cannot be matched within the tolerance, and
// too many control points.
Result<CompatiblePatches> make_compatible(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
