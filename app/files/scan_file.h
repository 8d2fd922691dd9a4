// Meshes, point clouds and scans read from files. A child process with limits on time and memory parses each
// file, so that a hostile one cannot crash the session.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>

#include "app/files/length_unit.h"
#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/scans/point_cloud.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Maximum number of triangles of a scan. A closed mesh has about twice as many triangles as vertices, so this
// is twice point_limit.
inline constexpr std::size_t scan_triangle_limit = 10'000'000;

struct MeshReading {
  // Unit of the file's numbers. Default: metres for PLY and PCD, millimetres for all others.
  std::optional<LengthUnit> unit;
  std::size_t triangle_limit = mesh_triangle_limit;
  // Program whose commands `read-mesh FILE` and `read-points FILE` parse the file. Default: the running
  // program. A test must set it, because the running program is then the test itself.
  std::filesystem::path program = "/proc/self/exe";
  std::chrono::milliseconds patience{60'000};  // time limit of the child
};

struct MeshFile {
  TriangleMesh mesh;  // mesh in metres; neither cleaned nor checked for invalid indices
  LengthUnit unit = millimetre;
};

// Reads an OBJ, STL or PLY file of at most 512 MiB. Every error names the file. Errors: another extension; a
// file that is missing, unreadable, empty, truncated or malformed; a child that crashes, runs out of time or
// needs more than 4 GiB; more triangles than triangle_limit, or more vertices than three times that limit.
Result<MeshFile> read_mesh_file(const std::filesystem::path& file, const MeshReading& reading = {});

// Reads a point cloud of at most 1 GiB in the file's own unit. Returns nullopt if a PLY or OBJ file has
// faces, which make it a mesh. The formats are those of engine/exchange/scans/point_cloud.h. Errors are those
// of read_mesh_file().
Result<std::optional<PointCloud>> read_cloud_file(const std::filesystem::path& file,
                                                  const MeshReading& reading = {});

struct ScanFile {
  Scan scan;  // coordinates are finite, in metres and within position_range_m
  LengthUnit unit = millimetre;
  std::size_t points_read = 0;
  std::size_t points_skipped = 0;  // points with a coordinate that is not a number
};

// Reads a scan: a point cloud, or a mesh of at most scan_triangle_limit triangles. A PLY file is read only
// once. Errors are those of read_mesh_file() and read_cloud_file(), points at infinity, and points farther
// away than 100 m.
Result<ScanFile> read_scan_file(const std::filesystem::path& file, const MeshReading& reading = {});

}  // namespace spoonbill
