// Fuzz targets for readers of point clouds and meshes.
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>
#include <variant>

#include "engine/exchange/mesh_import.h"
#include "engine/exchange/scans/ply_file.h"
#include "engine/exchange/scans/point_cloud.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/targets/targets.h"

namespace spoonbill {

namespace {

void take_cloud(const Result<PointCloud>& cloud, std::size_t bytes) {
  if (!cloud) return must_be_one_line(cloud.error());
  // A compressed cloud may have more points than the file has bytes, but at most a hundred points per byte.
  must_hold(cloud->points.size() <= 100 * bytes, "a small file holds few points");
  for (const Vector3& point : cloud->points) must_hold(point.allFinite(), "points are finite");
}

void take_file(std::string_view bytes, const std::function<Status(const std::filesystem::path&)>& check) {
  const int file = memfd_create("fuzzed", 0);
  must_hold(file >= 0, "memory for a file");
  must_hold(write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()), "a written file");
  const Status status = check("/proc/self/fd/" + std::to_string(file));
  close(file);
  if (!status) must_be_one_line(status.error());
}

}  // namespace

// Tests the reader of PLY files, which contain meshes or clouds.
void take_ply(std::string_view bytes) {
  const auto content = parse_ply(bytes);
  if (!content) return must_be_one_line(content.error());
  if (const auto* cloud = std::get_if<PointCloud>(&content.value())) return take_cloud(*cloud, bytes.size());
  const PlyMesh& mesh = std::get<PlyMesh>(content.value());
  must_hold(mesh.vertices.size() <= bytes.size(), "a small file holds few vertices");
  must_hold(mesh.triangles.size() <= bytes.size(), "a small file holds few triangles");
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      must_hold(corner < mesh.vertices.size(), "corners are vertices");
    }
  }
}

// Tests the readers of point clouds. The first byte selects the format of the cloud.
void take_points(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view rest = bytes.substr(1);
  switch (bytes[0] % 4) {
    case 0:
      return take_ply(rest);
    case 1:
      return take_cloud(parse_pcd_points(rest), bytes.size());
    case 2:
      return take_cloud(parse_text_points(rest), bytes.size());
    default:
      return take_cloud(parse_obj_points(rest), bytes.size());
  }
}

// Tests the readers of text meshes. The first byte selects the format of the mesh.
void take_mesh_text(std::string_view bytes) {
  if (bytes.empty()) return;
  const bool is_stl = bytes[0] % 2 == 0;
  take_file(bytes.substr(1), [&](const std::filesystem::path& file) {
    return is_stl ? check_text_stl(file) : check_last_obj_line(file);
  });
}

}  // namespace spoonbill
