// How near two patches of surfaces can be, from their corners.
#pragma once

#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// A lower bound of the distance between two patches: their bilinear patches lie in the hulls of their
// corners, which some direction separates, and the surfaces leave those by their bulges at most.
double patch_distance(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b);

// The same from directions across the sides of each patch, within its plane: what tells slivers apart that
// lie side by side.
double patch_distance_aside(const PatchCorners& a, double bulge_a, const PatchCorners& b, double bulge_b);

}  // namespace spoonbill
