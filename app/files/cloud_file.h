// Point clouds, read by a child process with limits, as meshes are.
#pragma once

#include <filesystem>
#include <optional>

#include "app/files/mesh_file.h"
#include "engine/base/result.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {

// In the file's own unit, by the ending of its name; nothing of a PLY or OBJ file with faces, which is a
// mesh. `reading` names the program whose command `read-points FILE` reads, and its patience. Refused, each
// with one line that names the file: another ending; missing, a folder or device, unreadable, empty, above 1
// GiB; what is no such cloud (engine/exchange/points/point_cloud.h); what crashes the child, takes it longer
// than the patience or more than 4 GiB.
Result<std::optional<PointCloud>> read_cloud_file(const std::filesystem::path& file,
                                                  const MeshReading& reading = {});

}  // namespace spoonbill
