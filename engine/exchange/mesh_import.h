// Import of triangle meshes from foreign files: PLY by parse_ply() of scans/ply_file.h, STL and OBJ through
// Assimp after checks that the file is complete. A hostile file can take over the process, so call these
// functions in a child process with limits. Each Error says what is wrong, without the file's name.
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Reads the triangles of an STL, OBJ or PLY file; polygons are triangulated, points and lines are ignored.
// Coordinates are in the file's own unit (not yet metres); coordinates from STL and OBJ have single
// precision. Other files that the file names, such as materials, are not opened.
Result<TriangleMesh> import_mesh(const std::filesystem::path& file);

// Checks that an STL file in text form ends with `endsolid`, with or without a name and a line feed. Binary
// files are accepted: Assimp checks their length.
Status check_text_stl(const std::filesystem::path& file);

// Checks the last line of an OBJ file if no line feed ends it. A vertex or a normal needs three numbers. A
// face needs three or more corners, all written in the same form, such as "7/1". A file that is cut off
// between two lines, or within the last number, is accepted.
Status check_last_obj_line(const std::filesystem::path& file);

}  // namespace spoonbill
