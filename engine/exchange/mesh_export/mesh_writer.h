// Triangle meshes to files of STL, OBJ, PLY and 3MF, in a unit of choice.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
  bool closed = true;  // 3MF tells solids from sheets
};

// What takes a file's bytes, part after part. An empty part only asks whether to go on, between steps that
// have nothing to write yet.
using TakeBytes = std::function<Status(std::string_view)>;

// STL binary, in single precision as the format has it; OBJ as text with every digit, an object for each
// mesh; PLY binary in double precision, one after the other; 3MF as a zip with an object for each mesh,
// always in millimetres. `format` must be one of these. `unit_m` is the length of one of the file's numbers.
// Refused: more triangles than the format's indices count; what take() refuses.
Status write_meshes(const std::vector<NamedMesh>& meshes, FileFormat format, double unit_m,
                    const TakeBytes& take);

}  // namespace spoonbill
