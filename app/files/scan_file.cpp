#include "app/files/scan_file.h"

#include <algorithm>
#include <string>
#include <utility>

#include "app/files/cloud_file.h"
#include "engine/base/text.h"
#include "engine/base/geometry.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

bool is_in_metres(FileFormat format) {
  return format == FileFormat::ply || format == FileFormat::pcd;
}

Status check_places(const std::filesystem::path& file, const ScanFile& scan) {
  for (std::size_t p = 0; p < scan.scan.points_m.size(); ++p) {
    const double farthest = scan.scan.points_m[p].cwiseAbs().maxCoeff();
    if (farthest <= position_range_m.high) continue;
    return Error{file.string() + ": point " + std::to_string(p + 1) + " has a coordinate of " +
                 number_text(farthest / scan.unit.metres) + " " + std::string(scan.unit.name) +
                 ", at most 100 m are taken; name the unit of its numbers with --unit, or move it"};
  }
  return {};
}

// Triangles with a corner that is no number go with it.
Status drop_not_a_number(const std::filesystem::path& file, ScanFile& scan) {
  std::vector<std::uint32_t> place(scan.scan.points_m.size());
  std::uint32_t kept = 0;
  for (std::size_t p = 0; p < place.size(); ++p) {
    const Vector3& point = scan.scan.points_m[p];
    place[p] = kept;
    if (point.hasNaN()) {
      place[p] = 0xffffffffU;
      ++scan.points_skipped;
      continue;
    }
    if (!point.allFinite()) {
      return Error{file.string() + ": vertex " + std::to_string(p + 1) +
                   " lies at infinity; export the mesh anew"};
    }
    scan.scan.points_m[kept++] = point;
  }
  if (scan.points_skipped == 0) return {};
  scan.scan.points_m.resize(kept);
  std::erase_if(scan.scan.triangles, [&](const TriangleCorners& corners) {
    return std::any_of(corners.begin(), corners.end(), [&](auto c) { return place[c] == 0xffffffffU; });
  });
  for (TriangleCorners& corners : scan.scan.triangles) {
    for (std::uint32_t& corner : corners) corner = place[corner];
  }
  return {};
}

Result<ScanFile> read_mesh_scan(const std::filesystem::path& file, MeshReading reading) {
  reading.triangle_limit = scan_triangle_limit;
  auto mesh = read_mesh_file(file, reading);
  if (!mesh) return mesh.error();
  ScanFile scan{{std::move(mesh->mesh.vertices_m), {}, std::move(mesh->mesh.triangles)}, mesh->unit};
  scan.points_read = scan.scan.points_m.size();
  for (const TriangleCorners& corners : scan.scan.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= scan.points_read) {
        return Error{file.string() + ": a triangle names a vertex that is not there; export it anew"};
      }
    }
  }
  if (scan.scan.triangles.empty()) return Error{file.string() + ": has no triangles"};
  if (Status dropped = drop_not_a_number(file, scan); !dropped) return dropped.error();
  return scan;
}

ScanFile scan_of(PointCloud cloud, LengthUnit unit) {
  ScanFile scan{{std::move(cloud.points), std::move(cloud.normals), {}}, unit};
  scan.points_skipped = cloud.skipped;
  scan.points_read = scan.scan.points_m.size() + cloud.skipped;
  for (Vector3& point : scan.scan.points_m) point *= scan.unit.metres;
  for (Vector3& normal : scan.scan.normals) {
    const double length = normal.norm();
    normal = length > 1e-6 && length < 1e6 ? Vector3(normal / length) : Vector3::Zero();
  }
  return scan;
}

Result<ScanFile> read_any(const std::filesystem::path& file, const MeshReading& reading) {
  const FileFormat format = format_from_name(file);
  if (format == FileFormat::stl) return read_mesh_scan(file, reading);
  if (!is_cloud(format)) {
    return Error{
        file.string() +
        ": is no scan by its name; .ply, .pcd, .xyz, .txt, .csv, .asc, .pts, .obj and .stl are read"};
  }
  auto cloud = read_cloud_file(file, reading);
  if (!cloud) return cloud.error();
  if (!cloud.value()) return read_mesh_scan(file, reading);
  return scan_of(std::move(*cloud.value()), reading.unit.value_or(is_in_metres(format) ? metre : millimetre));
}

}  // namespace

Result<ScanFile> read_scan_file(const std::filesystem::path& file, const MeshReading& reading) {
  auto scan = read_any(file, reading);
  if (!scan) return scan;
  if (Status checked = check_places(file, scan.value()); !checked) return checked.error();
  return scan;
}

}  // namespace spoonbill
