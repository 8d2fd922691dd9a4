// Joins patches that follow each other along v. Rows are first prepared: made compatible, cut back for
// blends, and measured at their joints. The functions have no side effects, may run on any thread, and are
// too slow for a tick.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/compatible_patches.h"

namespace spoonbill {

// Measures of the joint between two patches of a row. Parameter lengths refer to the patch before the joint.
struct JointMeasure {
  bool bridged = false;
  double gap_m = 0.0;          // largest gap between the edges; mean gap at a bridge
  double gap_parameter = 0.0;  // length of a bridge along v
  // Factor on the length of the next patch's domain that makes the speed equal on both sides of the joint.
  double stretch_of_after = 1.0;
  double apart_m = 0.0;     // largest gap before patches were cut back
  double cut_back_m = 0.0;  // length cut off each of the two patches
};

// Patches in order along v, with a common knot vector along u.
struct PreparedRow {
  std::vector<Surface> patches;
  std::vector<JointMeasure> joints;
  double deviation_m = 0.0;
};

// Prepares adjacent rows with equal numbers of patches. All patches of a column get the v domain of the
// column's first patch, and are cut back and joined at the same parameters. They are cut back in two cases:
// for a requested blend, if the joint lacks the continuity; and at small gaps where the patches do not
// continue straight ahead, to avoid a step. Fails if no blend is requested and a joint touches in one row and
// is open in another. Fails if a blend takes more than half of a patch, or if make_compatible() or
// bridge_length() fails.
Result<std::vector<PreparedRow>> prepare_rows(std::vector<std::vector<Surface>> rows,
                                              const JoinRequest& request);

// A joint of the merged surface. The surface differs from the patches between blend_start and blend_end along
// v. These two parameters are equal if there is no blend or bridge.
struct Joint {
  double gap_m = 0.0;
  bool bridged = false;
  double blend_start = 0.0, blend_end = 0.0;
  double blend_length_m = 0.0;  // mean length of the blend in metres
  double apart_m = 0.0;         // largest gap between the given edges
  double cut_back_m = 0.0;      // length cut off each of the two patches for the blend
};

struct Joined {
  Surface surface;
  double deviation_m = 0.0;  // largest distance from the patches at equal parameters, outside blends
  std::vector<Joint> joints;
};

// Joins the patches of a row. The result is exact if the derivatives up to the continuity agree. Otherwise
// the multiplicity of the joint knot is reduced by fitting, and knots are added beside it until the tolerance
// is met. A knot of multiplicity m has continuity C^(p - m) at degree p. Patches with r1 and r2 control
// points give r1 + r2 + m - p - 1 (Pungotra et al. 2013 give r1 + r2 - 1, which holds for C0 only). Fails if
// too many control points are needed, if the result has folds that no patch has (unless bridges may fold), or
// if stopped.
Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request);

// Prepares and joins a single row. Edges within the tolerance are joined directly, all others by a bridge.
Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
