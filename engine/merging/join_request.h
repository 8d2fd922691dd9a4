// How patches are to be joined. A value.
#pragma once

#include "engine/base/progress.h"

namespace spoonbill {

struct JoinRequest {
  int continuity = 2;         // C0 to C8
  double tolerance_m = 5e-5;  // of the merged surface to the patches, outside blends
  double spent_m = 0.0;       // of the tolerance, by what was done to the patches before or will be after
  double blend_m = 0.0;       // the length of a blend at joints that are not of the continuity; 0 = none
  double twist = 0.0;         // shares of a turn by which each ring is turned from where it fits best
  int largest_count = 200;    // control points a direction
  bool shared_parameters = false;  // of parts made to follow each other across: no seam is looked for
  bool bridges_may_fold = false;   // where edges are held against each other on purpose
  Progress progress = {};          // of the whole work that the request is given to
};

}  // namespace spoonbill
