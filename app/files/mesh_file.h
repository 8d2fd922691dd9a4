// Mesh files, read by a child process with limits, so that a hostile one cannot take the session with it.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>

#include "app/files/length_unit.h"
#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct MeshReading {
  std::optional<LengthUnit>
      unit;  // of the file's numbers; millimetres for OBJ and STL, metres for PLY if none
  std::size_t triangle_limit = mesh_triangle_limit;
  // The program whose command `read-mesh FILE` reads: this one. A test must name it, being another program.
  std::filesystem::path program = "/proc/self/exe";
  std::chrono::milliseconds patience{60'000};
};

struct MeshFile {
  TriangleMesh mesh;  // in metres, as it stands in the file: not cleaned, indices not checked
  LengthUnit unit = millimetre;
};

// Refused, each with one line that names the file: another ending; missing, a folder or device, unreadable,
// empty, above 512 MiB; what is cut, where it can be told, or Assimp cannot read; what crashes it, takes it
// longer than the patience or more than 4 GiB; more triangles than the limit, or more than three vertices for
// each of that many.
Result<MeshFile> read_mesh_file(const std::filesystem::path& file, const MeshReading& reading = {});

}  // namespace spoonbill
