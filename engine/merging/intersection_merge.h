// Merges two patches that cross each other: each keeps what lies before the other, and where they meet is an
// edge or a fillet. No single B-spline patch holds such a corner exactly; both are resampled along lines of
// constant u that meet on the crossing, fitted, and joined. Outside the tick; pure function.
#pragma once

#include "engine/merging/join_row.h"

namespace spoonbill {

struct IntersectionRequest {
  JoinRequest join;       // the continuity is the fillet's
  double fillet_m = 0.0;  // the radius of a ball that rolls along the corner; 0 = an edge
};

struct IntersectionMerge {
  Surface surface;
  double deviation_m = 0.0;  // to the patches, outside the fillet
  // Where the patches meet; its blend is the fillet, which leaves them from blend_start to blend_end along v.
  Joint corner;
  bool first_was_inward = false, second_was_inward = false;
};

// Of closed bodies each keeps what lies outside the other; of open patches the longer part of their lines.
// A closed body whose normals point inwards is turned around first. The first keeps its parameters around. A
// closed body that the first does not cross around one of its poles is run through from the crossing to the
// pole on the far side (LinesFromLoop). Refused: patches whose lines of constant u do not each cross the
// other or do not follow each other along the crossing, one that leaves a closed body again, as where it goes
// through, a fillet that does not fit. The message names where. Stopped on request.
Result<IntersectionMerge> merge_crossing(const Surface& first, const Surface& second,
                                         const IntersectionRequest& request);

}  // namespace spoonbill
