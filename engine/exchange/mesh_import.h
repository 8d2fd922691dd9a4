// Import of triangle meshes from STL, OBJ and PLY files. Call it in a child process with limits. Each Error
// says what is wrong, without the file's name.
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Reads the triangles of a file, by parse_stl(), parse_obj_mesh() or parse_ply(). Coordinates are in the
// file's own unit (not yet metres). Other files that the file names are not opened.
Result<TriangleMesh> import_mesh(const std::filesystem::path& file);

}  // namespace spoonbill
