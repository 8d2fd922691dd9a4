// Joins patches that follow each other along v. Rows are first prepared: made compatible, cut back for
// blends, and measured at their joints. Pure functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/compatible_patches.h"

namespace spoonbill {

// Measures of the joint between two patches of a row. Parameter lengths are measured on the patch before the
// joint.
struct JointMeasure {
  bool bridged = false;
  double gap_m = 0.0;             // largest gap between the edges; the mean gap for a bridge
  double gap_parameter = 0.0;     // length of a bridge
  double stretch_of_after = 1.0;  // factor on the domain of the patch after the joint, for equal speed
  double apart_m = 0.0;           // largest gap before cutting back
  double cut_back_m = 0.0;        // length cut off each of the two patches
};

// Patches along v with a common knot vector along u.
struct PreparedRow {
  std::vector<Surface> patches;
  std::vector<JointMeasure> joints;
  double deviation_m = 0.0;
};

// Prepares adjacent rows of equally many patches. The patches of a column share the first row's v domain and
// are cut back and joined at the same parameters. They are cut back to fit a requested blend if the joint
// lacks the continuity, and at small gaps that are not straight ahead, far enough to avoid a step. Fails if a
// joint touches in one row and is open in another without a blend, or if a blend takes more than half of a
// patch. It also fails where make_compatible() and bridge_length() do.
Result<std::vector<PreparedRow>> prepare_rows(std::vector<std::vector<Surface>> rows,
                                              const JoinRequest& request);

// Joint of the merged surface, which differs from the patches from blend_start to blend_end along v; the two
// are equal without a blend or bridge.
struct Joint {
  double gap_m = 0.0;
  bool bridged = false;
  double blend_start = 0.0, blend_end = 0.0;
  double blend_length_m = 0.0;  // mean length of the blend along v
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
// is met. A knot of multiplicity m at degree p has continuity C^(p - m). Control point counts r1 and r2
// become r1 + r2 + m - p - 1 (Pungotra et al. 2013 give r1 + r2 - 1, which holds for C0 only). Fails on too
// many control points, on folds that no patch has (except where bridges may fold), or when stopped.
Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request);

// Prepares and joins a single row. Edges within the tolerance are joined directly, others by a bridge.
Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request);

}  // namespace spoonbill
