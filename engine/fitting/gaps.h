// Gaps between bodies that lie near each other in a cloud.
#pragma once

#include <vector>

#include "engine/fitting/point_graph.h"
#include "engine/fitting/voxels.h"

namespace spoonbill {

// Of the pairs of neighbouring nodes, those that bridge no gap. `points_m` are gathered into the nodes by the
// groups. A gap has no point within three times the widest step between the points of the nodes on either
// side, faces both of their surfaces rather than go on along them, as an unseen stripe of one surface would,
// and parts the nodes into bodies none of which is dust.
std::vector<NodePair> without_gaps(const std::vector<Vector3>& points_m, const VoxelGroups& groups,
                                   const std::vector<Vector3>& nodes_m, std::vector<NodePair> pairs);

}  // namespace spoonbill
