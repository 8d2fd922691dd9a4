// Joins patches that lie one after the other along v into one surface. Pure functions, outside the tick; any
// thread.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/prepared_rows.h"

namespace spoonbill {

// From blend_start to blend_end along v the merged surface leaves the patches; both are the same where it
// does not.
struct Joint {
  double gap_m = 0.0;
  bool bridged = false;
  double blend_start = 0.0, blend_end = 0.0;
  double blend_length_m = 0.0;  // the mean length of the blend along v
  double apart_m = 0.0;         // the largest gap between the edges as they were given
  double cut_back_m = 0.0;      // off either patch, for the blend
};

struct Joined {
  Surface surface;
  double deviation_m = 0.0;  // the largest distance to the patches at their parameters, outside blends
  std::vector<Joint> joints;
};

// Exact where derivatives up to the continuity agree; else the joint's knot is fitted to a lower multiplicity
// and knots are added beside it until the tolerance holds. At a joint-knot multiplicity m of degree p the
// continuity is C^(p - m), and of r1 and r2 control points r1 + r2 + m - p - 1 result (Pungotra et al. 2013
// give r1 + r2 - 1, which holds for C0 alone). Refused: more than the largest count of them, a surface that
// folds over where no patch does, unless bridges may. Stopped on request.
Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request);

// prepare_rows() of a single one, and join_prepared(). Patches whose edges are at most the tolerance apart
// are joined at the edge, others by a bridge.
Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
