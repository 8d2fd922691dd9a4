// Finer triangles of the same shape.
#pragma once

#include <cstddef>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Halves edges until none is longer than `longest_m`, each in both of its triangles, so that what was closed
// stays closed. Vertices keep their places, new ones follow. Edges must have two triangles each. Refused:
// more than `triangle_limit` triangles.
Result<TriangleMesh> refine_edges(TriangleMesh mesh, double longest_m, std::size_t triangle_limit);

}  // namespace spoonbill
