// Merges two intersecting patches at an edge or a fillet. A single B-spline patch cannot represent such a
// corner exactly, so both patches are resampled along lines of constant u that meet on the intersection, then
// fitted and joined. The function has no side effects and is too slow for a tick.
#pragma once

#include "engine/merging/join_row.h"

namespace spoonbill {

struct IntersectionRequest {
  JoinRequest join;       // its continuity applies to the ends of the fillet
  double fillet_m = 0.0;  // radius of the ball that rolls along the corner; 0 for a sharp edge
};

struct IntersectionMerge {
  Surface surface;
  double deviation_m = 0.0;  // largest distance from the patches, outside the fillet
  // Joint of the two patches. A fillet is stored as the joint's blend, from blend_start to blend_end along v.
  Joint corner;
  bool first_was_inward = false, second_was_inward = false;
};

// Merges two intersecting patches. Each patch contributes its part outside the other if the other is a closed
// body. Otherwise it contributes the longer part of its lines. Closed bodies with inward normals are reversed
// first. The first patch keeps its parameters in the direction around it. If the first patch crosses a closed
// body beside its poles, the body is resampled along lines from the intersection to the far pole.
//
// Fails if a line of constant u does not cross the other patch, if the lines of both patches are not in the
// same order along the intersection, if a patch leaves a closed body after entering it, or if the fillet does
// not fit. The message names a position where possible.
Result<IntersectionMerge> merge_crossing(const Surface& first, const Surface& second,
                                         const IntersectionRequest& request);

}  // namespace spoonbill
