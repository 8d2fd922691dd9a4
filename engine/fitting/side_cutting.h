// Finer triangles of the same shape, open or closed.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Halves sides until none is longer than `longest_m` or there are more triangles than the limit, each in all
// of its triangles, so that no gap opens. Points keep their places, new ones follow.
void cut_long_sides(std::vector<Vector3>& points_m, std::vector<TriangleCorners>& triangles, double longest_m,
                    std::size_t triangle_limit);

}  // namespace spoonbill
