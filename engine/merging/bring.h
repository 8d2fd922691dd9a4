// Moves a part to where its edge meets that of another part, so that the two can be merged. The functions
// have no side effects, may run on any thread, and are too slow for a tick.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/merging/merge.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

// A motion that brings one part to another.
struct Bringing {
  Pose pose;                          // moves the part
  Vector3 moved_m = Vector3::Zero();  // displacement of the centre of the part's edge
  double roll_rad = 0.0;              // part of the turn that is about the direction out of the edge
};

// Returns the motion of `moved` after which the given edge meets that of `still`:
// - position: the centres of the edges coincide; at a pole, the pole counts;
// - direction: the two point out of their parts in opposite directions, by the smallest turn;
// - roll: the rings of two tubes match best in shape, where several rolls match by the smallest; the normals
//   of other patches agree. The ring of a pole is where the sides become straight; without straight sides,
//   the roll is 0.
// Fails for an edge without a direction, and for a tube with a patch that is not a tube.
Result<Bringing> bring(const Surface& still, Side still_side, const Surface& moved, Side moved_side);

// A part that bring_parts() has moved, and the edges that meet.
struct BroughtPart {
  PatchEdge to, from;
  Bringing motion;
};

// Moves parts until each meets one that does not move any more; the first part stays. The chosen edges meet,
// in their order; without any, each part meets a part before it at the nearest ends of tubes. Fails like
// check_merge() and bring(), for a part that no chosen edges connect with the first, and for parts without
// chosen edges that are not tubes.
Result<std::vector<BroughtPart>> bring_parts(std::vector<Surface>& parts, const MergeRequest& request);

}  // namespace spoonbill
