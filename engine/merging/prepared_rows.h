// Rows of patches made ready to be joined: fitting each other across, cut back where they are to be blended,
// and measured at their joints. Pure functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/join_request.h"

namespace spoonbill {

// What lies between two patches of a row. Lengths are in the parameter of the patch before.
struct JointMeasure {
  bool bridged = false;
  double gap_m = 0.0;             // between the edges: the largest one, of a bridge the mean
  double gap_parameter = 0.0;     // of a bridge
  double stretch_of_after = 1.0;  // how the domain of the patch after must be stretched for one speed there
  double apart_m = 0.0;           // the largest gap before anything was cut back
  double cut_back_m = 0.0;        // off either patch
};

// Along v, over one knot vector along u.
struct PreparedRow {
  std::vector<Surface> patches;
  std::vector<JointMeasure> joints;
  double deviation_m = 0.0;
};

// Of rows that lie beside each other, each of as many patches. The patches of a column get the domain along v
// that its first row has, are cut back by the same parameters, and are joined at the same ones. They are cut
// back for a blend where one is asked for and their joint is not of the continuity, so that it becomes as
// long, and where they are apart by little but not straight on, by so much that no step remains. Refused:
// rows that touch at one place of a joint and are apart at another, unless a blend is asked for; what
// compatible_along_v() and bridge_length() refuse; a blend that takes more than half of a patch.
Result<std::vector<PreparedRow>> prepare_rows(std::vector<std::vector<Surface>> rows,
                                              const JoinRequest& request);

}  // namespace spoonbill
