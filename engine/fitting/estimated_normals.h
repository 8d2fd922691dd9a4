// Normals of a scan that came without any, good enough to tell where a surface turns back on itself.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/fitting/fit_points.h"

namespace spoonbill {

// Of each parameter in `uv`, which belong to the points in order (what comes after them gets zeros): across
// the plane along which the nodes about the point's own spread, made to agree from node to node, and facing
// as the surface does at the greater part of what hangs together. Zero where they spread along no plane, and
// where the surface faces the other way at more than a fifth of what hangs together: there both faces of a
// thin wall may be one to the nodes.
std::vector<Vector3> estimated_normals(const FitPoints& points, const Surface& surface,
                                       const std::vector<Vector2>& uv);

}  // namespace spoonbill
