// Meshes out of foreign files, through Assimp. What a hostile file does to Assimp it does to this process:
// call it in a child with limits (app/files/mesh_file.h).
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// The triangles as they stand in the file, polygons cut, points and lines left out, coordinates in the file's
// own unit (not yet metres) and single precision. No other file is opened, whatever this one names. The Error
// says what is wrong, without the file's name.
Result<TriangleMesh> import_mesh(const std::filesystem::path& file);

}  // namespace spoonbill
