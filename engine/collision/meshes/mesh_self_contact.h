// Whether a mesh passes through itself.
#pragma once

#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Any two triangles that meet count, but for those with a common corner, of which a millionth of their size
// at their rims is left out. `triangles` lie in the order of the tree's leaves. Takes about a microsecond a
// triangle where they do not; a mesh for which more than 200 pairs a triangle must be tested (needles across
// each other's boxes) is not searched to its end and counts as one that does.
bool meets_itself(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                  const BoxTree& tree);

}  // namespace spoonbill
