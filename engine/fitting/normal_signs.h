// Normals of a cloud that face either way, made to agree.
#pragma once

#include <vector>

#include "engine/fitting/point_graph.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Which normals must be turned so that they agree along the surface: those at either end of a chord of the
// surface are mirror images in the plane that halves it, and the pairs of which this is nearest to true, of
// either sign, tell it to the others (the least spanning tree of Hoppe et al. 1992). What hangs together
// follows the greater part of its normals where three in four agree, else faces away from its middle. Zero
// normals stay zero and tell nothing.
std::vector<bool> turned_to_agree(const std::vector<Vector3>& points_m, const std::vector<Vector3>& normals,
                                  const std::vector<NodePair>& pairs);

// The same of a scan's nodes and their nearest ones where the normals do not agree; else none of them.
// Neighbours with opposite normals do not agree where they lie beside each other along the surface; where one
// lies behind the other, they are the two faces of a wall.
std::vector<bool> normals_to_turn(const Scan& nodes);

}  // namespace spoonbill
