// Discs in the place of the points of a cloud, so that the cloud can be drawn as a surface.
#pragma once

#include <cstddef>

#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Returns a mesh with a hexagon for each point of a cloud, or for every n-th point if there are more than
// `limit`. A hexagon lies in the plane of the points around its own, or across its normal if the cloud has
// normals, and overlaps those around it. Its radius is at most twice and at
// least half the usual one, so that stray points do not hide others. The points must be finite.
TriangleMesh make_point_discs(const Scan& cloud, std::size_t limit);

}  // namespace spoonbill
