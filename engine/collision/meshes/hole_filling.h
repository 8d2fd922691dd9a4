// Closes the small holes of parts, so that they have an inside.
#pragma once

#include "engine/collision/meshes/mesh_parts.h"

namespace spoonbill {

// Marks as closed the parts whose holes are none or small (hole_share), fills those by a fan each about the
// mean of their rim, and returns how many were filled. A crack, a rim without area, needs no triangle.
std::size_t fill_small_holes(MeshParts& parts);

}  // namespace spoonbill
