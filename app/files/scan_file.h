// Scans: point clouds and meshes out of files, in metres.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "app/files/length_unit.h"
#include "app/files/mesh_file.h"
#include "engine/base/result.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// A closed mesh of five million points has twice as many triangles.
inline constexpr std::size_t scan_triangle_limit = 10'000'000;

struct ScanFile {
  Scan scan;  // finite, within position_range_m
  LengthUnit unit = millimetre;
  std::size_t points_read = 0;
  std::size_t points_skipped = 0;  // with a coordinate that is no number
};

// By the ending of the name: PLY and PCD, in metres if `unit` says nothing; STL, OBJ, XYZ and its like, in
// millimetres. A child process of the program that `reading` names reads them.
// Refused, each with one line that names the file: another ending, what cannot be read, more than five
// million points of a cloud or more triangles than the limit, points at infinity or farther than 100 m.
Result<ScanFile> read_scan_file(const std::filesystem::path& file, const MeshReading& reading = {});

}  // namespace spoonbill
