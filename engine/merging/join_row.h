// Joins patches that lie one after the other along v into one surface. Pure functions, outside the tick; any
// thread.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/result.h"

namespace spoonbill {

struct JoinRequest {
  int continuity = 2;         // C0 to C8
  double tolerance_m = 5e-5;  // of the merged surface to the patches, outside blends
  double blend_m = 0.0;       // the length of a blend at joints that are not of the continuity; 0 = none
  double twist = 0.0;         // shares of a turn by which each ring is turned from where it fits best
  int largest_count = 200;    // control points a direction
};

// What lies between two patches of a row. Lengths are in the parameter of the patch before.
struct JointMeasure {
  bool bridged = false;
  double gap_m = 0.0;          // the mean distance of the edges
  double gap_parameter = 0.0;  // of a bridge
  double stretch_of_after =
      1.0;  // how the domain of the patch after must be stretched for one speed at the joint
};

// A row whose patches fit each other across (compatible_along_v), cut back where it is to be blended.
struct PreparedRow {
  std::vector<Surface> patches;
  std::vector<JointMeasure> joints;
  double deviation_m = 0.0;
};
Result<PreparedRow> prepare_row(std::vector<Surface> patches, const JoinRequest& request);

// From blend_start to blend_end along v the merged surface leaves the patches; both are the same where it
// does not.
struct Joint {
  double gap_m = 0.0;
  bool bridged = false;
  double blend_start = 0.0, blend_end = 0.0;
  double blend_length_m = 0.0;  // the mean length of the blend along v
};

struct Joined {
  Surface surface;
  double deviation_m = 0.0;  // the largest distance to the patches at their parameters, outside blends
  std::vector<Joint> joints;
};

// Exact where derivatives up to the continuity agree; else the joint's knot is fitted to a lower multiplicity
// and knots are added beside it until the tolerance holds. At a joint-knot multiplicity m of degree p the
// continuity is C^(p - m), and of r1 and r2 control points r1 + r2 + m - p - 1 result (Pungotra et al. 2013
// give r1 + r2 - 1, which holds for C0 alone).
Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request);

// Both. Patches whose edges are at most the tolerance apart are joined at the edge, others by a bridge.
Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
