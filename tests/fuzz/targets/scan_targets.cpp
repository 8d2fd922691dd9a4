// Fuzz targets for readers of point clouds and meshes.
#include <variant>

#include "engine/exchange/scans/obj_file.h"
#include "engine/exchange/scans/ply_file.h"
#include "engine/exchange/scans/point_cloud.h"
#include "engine/exchange/scans/stl_file.h"
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

void take_mesh(const Result<FileMesh>& mesh, std::size_t bytes) {
  if (!mesh) return must_be_one_line(mesh.error());
  must_hold(mesh->vertices.size() <= bytes, "a small file holds few vertices");
  must_hold(mesh->triangles.size() <= bytes, "a small file holds few triangles");
  for (const auto& corners : mesh->triangles) {
    for (const std::uint32_t corner : corners)
      must_hold(corner < mesh->vertices.size(), "corners are vertices");
  }
}

}  // namespace

// Tests the reader of PLY files, which contain meshes or clouds.
void take_ply(std::string_view bytes) {
  const auto content = parse_ply(bytes);
  if (!content) return must_be_one_line(content.error());
  if (const auto* cloud = std::get_if<PointCloud>(&content.value())) return take_cloud(*cloud, bytes.size());
  take_mesh(std::get<FileMesh>(content.value()), bytes.size());
}

void take_stl(std::string_view bytes) {
  take_mesh(parse_stl(bytes), bytes.size());
}

void take_obj(std::string_view bytes) {
  take_mesh(parse_obj_mesh(bytes), bytes.size());
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

}  // namespace spoonbill
