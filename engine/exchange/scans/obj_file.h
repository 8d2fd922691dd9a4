// Reader of the faces of OBJ files.
#pragma once

#include <string_view>

#include "engine/base/result.h"
#include "engine/exchange/scans/file_mesh.h"

namespace spoonbill {

// Reads the vertices and faces of an OBJ file. Polygons are cut into triangles. Corners may count from the
// end, and a backslash continues a line. Everything else is ignored: points, lines, free-form geometry,
// groups, and other files that the file names, such as materials, which are not opened.
//
// Refused: a vertex without three numbers, a corner without a vertex, a face with fewer than three corners or
// more than face_corner_limit, a file without faces, and a last line that no line feed ends and that is not
// complete. A file that is cut off between two lines, or within the last number, is accepted.
Result<FileMesh> parse_obj_mesh(std::string_view bytes);

}  // namespace spoonbill
