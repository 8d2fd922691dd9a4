// Contents of mesh files as other programs write them.
#pragma once

#include <string>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// All numbers are written as they are in the mesh, without a change of unit.
std::string binary_stl(const TriangleMesh& mesh);
std::string ascii_stl(const TriangleMesh& mesh);
std::string obj_text(const TriangleMesh& mesh);
std::string ply_text(const TriangleMesh& mesh);
std::string binary_ply(const TriangleMesh& mesh);

}  // namespace spoonbill
