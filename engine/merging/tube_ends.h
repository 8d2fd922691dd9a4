// The ends of tubes: rings, where they are open, or poles. Closes rings with caps, opens poles where another
// tube is to be joined. Pure functions, outside the tick; any thread. A tube is closed around in one
// direction and open along the other.
#pragma once

#include <utility>
#include <vector>

#include "engine/merging/join_row.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

bool is_tube(const Surface& surface);

// The two sides that a tube ends at. Only of tubes.
std::pair<Side, Side> tube_sides(const Surface& surface);

bool is_pole(const Surface& surface, Side side);

// The tube's ring at a side: its middle and mean radius, which is zero at a pole, and the unit direction out
// of the tube.
struct TubeEnd {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 outward = Vector3::Zero();
};
TubeEnd tube_end(const Surface& surface, Side side);

// Closes an open end by a cap that bulges by `height_m` over a ring that is about plane; at a height above
// zero the cap continues the tube's sides with the continuity that is asked, at zero it is flat and meets
// them at an edge. A quarter of an ellipse, by the cubic that has its tangents and its middle (Goldapp 1991).
// Refused: a flat cap of a ring whose middle does not see all of its rim, which would fold over.
Result<Joined> with_cap(const Surface& surface, Side side, double height_m, const JoinRequest& request);

// Cuts a pole off so that the tube ends in a ring to be joined: where its sides first run straight (the
// radius grows by less than 0.1 of the way along), or sooner where the ring is as wide as `wide_enough_m`.
// Refused where half of the tube would go.
Result<Surface> opened_pole(const Surface& surface, Side side, double wide_enough_m);

// The pairs of ends by which tubes hang together: nearest ends first, of equally near ones those that are
// about as wide, each used once.
std::vector<std::pair<PatchEdge, PatchEdge>> nearest_ends(const std::vector<Surface>& tubes);

}  // namespace spoonbill
