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
//   of other patches agree. The ring of a pole is that at which merge() cuts it off.
// Fails for an edge without a direction, and for a tube and a patch that is none.
Result<Bringing> bring(const Surface& still, Side still_side, const Surface& moved, Side moved_side);

// A part that bring_parts() has moved, and the edges that meet.
struct BroughtPart {
  PatchEdge to, from;
  Bringing motion;
};

// Moves each part after the first to one of the parts before it. `chosen` names the edges that meet; without
// it, the nearest ends of tubes do. Fails like bring(), for a part that `chosen` does not connect with one
// before it, and for parts without chosen edges that are no tubes.
Result<std::vector<BroughtPart>> bring_parts(std::vector<Surface>& parts,
                                             const std::vector<ChosenEdges>& chosen);

}  // namespace spoonbill
