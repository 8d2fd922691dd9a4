// Triangles without area, which trim loops leave whose corners are as high as each other.
#pragma once

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// The same mesh without triangles lower than a nanometre: their corners are merged where they are as near, or
// become corners of the neighbour beyond their longest edge, so that no gap opens.
void remove_slivers(TriangleMesh& mesh);

}  // namespace spoonbill
