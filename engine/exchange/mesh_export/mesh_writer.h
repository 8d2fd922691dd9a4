// Writer of triangle meshes to STL, OBJ, PLY and 3MF.
#pragma once

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
  bool closed = true;  // true for a solid, false for a sheet; only 3MF stores it
};

// Receiver of a file's bytes, part by part. The writer of 3MF also sends empty parts, to ask whether to
// continue. An error from the receiver stops the writer.
using ByteSink = std::function<Status(std::string_view)>;

// Writes meshes to a file. STL is binary in single precision, as the format requires. OBJ is text with all
// digits and one object for each mesh. PLY is binary in double precision, with all meshes merged. 3MF (3D
// Manufacturing Format, core specification 1.3) is a zip with one object for each mesh, always in
// millimetres. `format` must be one of these four. `unit_m` is the length of one unit of the file. Refused:
// more triangles than the format can index, errors of libzip and of the sink.
Status write_meshes(const std::vector<NamedMesh>& meshes, FileFormat format, double unit_m,
                    const ByteSink& sink);

}  // namespace spoonbill
