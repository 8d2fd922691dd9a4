// The points of a cloud that belong to no surface.
#pragma once

#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Those whose neighbours are much farther than those of others. `counts` tells how many points given each
// stands for: 1, or those of its voxel where the cloud was thinned. Most points given lie on the surface,
// however many voxels the others fill: they say what is usual. Of a thinned cloud, what stands for far fewer
// points than is usual lies apart as well; and what lies flat among its neighbours, as they do among theirs,
// is a part of the surface that was seen less densely, and does not.
std::vector<bool> lie_apart(const std::vector<Vector3>& points_m, const std::vector<double>& counts);

}  // namespace spoonbill
