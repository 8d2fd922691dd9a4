// Reader of STL files.
#pragma once

#include <string_view>

#include "engine/base/result.h"
#include "engine/exchange/scans/file_mesh.h"

namespace spoonbill {

// Reads an STL file. It is in binary form if its length matches the count of triangles after its first 80
// bytes, whatever these bytes are, and otherwise in text form. Each triangle has three vertices of its own.
// Normals, names and attributes are ignored; keywords may be in capitals.
//
// Refused: a text that does not begin with `solid`, has a word out of place, a coordinate that is not a
// number, or does not end with `endsolid`, with or without a name.
Result<FileMesh> parse_stl(std::string_view bytes);

}  // namespace spoonbill
