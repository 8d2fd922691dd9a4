#include "app/files/scan_file.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <variant>

#include "app/files/foreign_child.h"
#include "engine/base/file.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr std::size_t mesh_file_bytes_limit = std::size_t{512} << 20;
// Remedies for error messages about files that exceed the limits of the child process.
const char* const reduce_mesh = "reduce the mesh";
const char* const thin_cloud = "thin it out";

// Marks a removed vertex in a table of new indices.
constexpr std::uint32_t no_vertex = 0xffffffffU;

std::string upper_case_ending(FileFormat format) {
  std::string name(usual_ending(format));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return name;
}

ForeignTask mesh_task(const std::filesystem::path& file) {
  ForeignTask task{file, "mesh", reduce_mesh};
  task.refusal = [format = upper_case_ending(format_from_name(file))](const std::string& reason) {
    return "cannot be read as " + format + " (" + ForeignTask::printable(reason) + "); export it again";
  };
  return task;
}

Status check_mesh_counts(const std::filesystem::path& file, const MeshCounts& counts, std::size_t limit) {
  if (counts.triangles > limit || counts.vertices > 3 * limit) {
    return Error{ErrorCode::too_many, file.string() + ": has " + std::to_string(counts.triangles) +
                                          " triangles with " + std::to_string(counts.vertices) +
                                          " vertices, more than the limit of " + std::to_string(limit) +
                                          " triangles; reduce the mesh"};
  }
  return {};
}

bool are_valid_counts(const CloudCounts& counts) {
  return counts.points <= point_limit && (counts.normals == 0 || counts.normals == counts.points);
}

bool is_in_metres(FileFormat format) {
  return format == FileFormat::ply || format == FileFormat::pcd;
}

Status check_coordinates(const std::filesystem::path& file, const ScanFile& scan) {
  for (std::size_t p = 0; p < scan.scan.points_m.size(); ++p) {
    const double farthest = scan.scan.points_m[p].cwiseAbs().maxCoeff();
    if (farthest <= position_range_m.high) continue;
    return Error{ErrorCode::out_of_range,
                 file.string() + ": point " + std::to_string(p + 1) + " has a coordinate of " +
                     number_text(farthest / scan.unit.metres) + " " + std::string(scan.unit.name) +
                     ", more than 100 m; give the unit of its numbers with --unit, or move it",
                 "--unit"};
  }
  return {};
}

// Removes vertices with a coordinate that is not a number, and the triangles that use them. Returns an error
// for a vertex at infinity.
Status drop_invalid_vertices(const std::filesystem::path& file, ScanFile& scan) {
  std::vector<std::uint32_t> new_index(scan.scan.points_m.size());
  std::uint32_t kept = 0;
  for (std::size_t p = 0; p < new_index.size(); ++p) {
    const Vector3& point = scan.scan.points_m[p];
    new_index[p] = kept;
    if (point.hasNaN()) {
      new_index[p] = no_vertex;
      ++scan.points_skipped;
      continue;
    }
    if (!point.allFinite()) {
      return Error{ErrorCode::out_of_range, file.string() + ": vertex " + std::to_string(p + 1) +
                                                " is at infinity; export the mesh again"};
    }
    scan.scan.points_m[kept++] = point;
  }
  if (scan.points_skipped == 0) return {};
  scan.scan.points_m.resize(kept);
  std::erase_if(scan.scan.triangles, [&](const TriangleCorners& corners) {
    return std::any_of(corners.begin(), corners.end(), [&](auto c) { return new_index[c] == no_vertex; });
  });
  for (TriangleCorners& corners : scan.scan.triangles) {
    for (std::uint32_t& corner : corners) corner = new_index[corner];
  }
  return {};
}

Result<ScanFile> scan_from_mesh(const std::filesystem::path& file, MeshFile mesh) {
  ScanFile scan{{std::move(mesh.mesh.vertices_m), {}, std::move(mesh.mesh.triangles)}, mesh.unit};
  scan.points_read = scan.scan.points_m.size();
  for (const TriangleCorners& corners : scan.scan.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= scan.points_read) {
        return Error{ErrorCode::inconsistent,
                     file.string() + ": a triangle refers to a vertex that does not exist; export it again"};
      }
    }
  }
  if (scan.scan.triangles.empty()) return Error{ErrorCode::too_few, file.string() + ": has no triangles"};
  if (Status dropped = drop_invalid_vertices(file, scan); !dropped) return dropped.error();
  return scan;
}

Result<ScanFile> read_mesh_scan(const std::filesystem::path& file, const MeshReading& reading) {
  auto mesh = read_mesh_file(file, reading);
  if (!mesh) return mesh.error();
  return scan_from_mesh(file, std::move(mesh).value());
}

ScanFile scan_from_cloud(PointCloud cloud, LengthUnit unit) {
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

// Receives the mesh that a frame of kind `mesh` contains, and converts it to metres.
Result<MeshFile> receive_mesh(ForeignChild& child, const FrameHead& head, const std::filesystem::path& file,
                              const MeshReading& reading) {
  MeshCounts counts;
  if (head.kind != FrameKind::mesh || head.bytes < sizeof counts) return child.invalid_answer();
  if (Status got = child.read(&counts, sizeof counts); !got) return got.error();
  if (Status status = check_mesh_counts(file, counts, reading.triangle_limit); !status) return status.error();
  if (head.bytes != mesh_frame_bytes(counts)) return child.invalid_answer();
  MeshFile result;
  result.unit = reading.unit.value_or(is_in_metres(format_from_name(file)) ? metre : millimetre);
  result.mesh.vertices_m.resize(counts.vertices);
  result.mesh.triangles.resize(counts.triangles);
  if (Status got = child.read(result.mesh.vertices_m); !got) return got.error();
  if (Status got = child.read(result.mesh.triangles); !got) return got.error();
  for (Vector3& vertex : result.mesh.vertices_m) vertex *= result.unit.metres;
  return result;
}

// Receives the point cloud that a frame of kind `cloud` contains.
Result<PointCloud> receive_cloud(ForeignChild& child, const FrameHead& head) {
  CloudCounts counts;
  if (head.kind != FrameKind::cloud || head.bytes < sizeof counts) return child.invalid_answer();
  if (Status got = child.read(&counts, sizeof counts); !got) return got.error();
  if (!are_valid_counts(counts) || head.bytes != cloud_frame_bytes(counts)) return child.invalid_answer();
  PointCloud cloud;
  cloud.points.resize(counts.points);
  cloud.normals.resize(counts.normals);
  cloud.skipped = counts.skipped;
  if (Status got = child.read(cloud.points); !got) return got.error();
  if (Status got = child.read(cloud.normals); !got) return got.error();
  return cloud;
}

// A point cloud, the mesh of a PLY file, or std::monostate. std::monostate stands for the mesh of an OBJ
// file, which read_mesh_scan() must read.
using ScanContent = std::variant<std::monostate, PointCloud, MeshFile>;

Result<ScanContent> read_content(const std::filesystem::path& file, const MeshReading& reading) {
  if (Status status = check_file(file, point_file_bytes_limit, thin_cloud); !status) return status.error();
  auto child =
      ForeignChild::start({file, "cloud", thin_cloud},
                          {reading.program.string(), "read-points", "--", file.string()}, reading.patience);
  if (!child) return child.error();
  const auto head = child->next();
  if (!head) return head.error();
  if (head->kind == FrameKind::faces) return ScanContent();
  if (head->kind == FrameKind::mesh) {
    auto mesh = receive_mesh(child.value(), head.value(), file, reading);
    return mesh ? Result<ScanContent>(std::move(mesh).value()) : mesh.error();
  }
  auto cloud = receive_cloud(child.value(), head.value());
  return cloud ? Result<ScanContent>(std::move(cloud).value()) : cloud.error();
}

Result<ScanFile> read_mesh_or_cloud(const std::filesystem::path& file, MeshReading reading) {
  reading.triangle_limit = scan_triangle_limit;
  const FileFormat format = format_from_name(file);
  if (format == FileFormat::stl) return read_mesh_scan(file, reading);
  if (!is_cloud(format)) {
    return Error{ErrorCode::unsupported,
                 file.string() +
                     ": does not have the ending of a scan: .ply, .pcd, .xyz, .txt, .csv, .asc, "
                     ".pts, .obj or .stl"};
  }
  auto content = read_content(file, reading);
  if (!content) return content.error();
  if (auto* mesh = std::get_if<MeshFile>(&content.value())) return scan_from_mesh(file, std::move(*mesh));
  if (auto* cloud = std::get_if<PointCloud>(&content.value())) {
    return scan_from_cloud(std::move(*cloud),
                           reading.unit.value_or(is_in_metres(format) ? metre : millimetre));
  }
  return read_mesh_scan(file, reading);
}

}  // namespace

Result<MeshFile> read_mesh_file(const std::filesystem::path& file, const MeshReading& reading) {
  const FileFormat format = format_from_name(file);
  if (!is_mesh(format)) {
    return Error{ErrorCode::unsupported,
                 file.string() + ": does not have the ending of a mesh: .obj, .stl or .ply"};
  }
  if (Status status = check_file(file, mesh_file_bytes_limit, reduce_mesh); !status) return status.error();
  auto child = ForeignChild::start(
      mesh_task(file), {reading.program.string(), "read-mesh", "--", file.string()}, reading.patience);
  if (!child) return child.error();
  const auto head = child->next();
  if (!head) return head.error();
  return receive_mesh(child.value(), head.value(), file, reading);
}

Result<std::optional<PointCloud>> read_cloud_file(const std::filesystem::path& file,
                                                  const MeshReading& reading) {
  auto content = read_content(file, reading);
  if (!content) return content.error();
  if (auto* cloud = std::get_if<PointCloud>(&content.value())) return std::optional(std::move(*cloud));
  return std::optional<PointCloud>();
}

Result<ScanFile> read_scan_file(const std::filesystem::path& file, const MeshReading& reading) {
  auto scan = read_mesh_or_cloud(file, reading);
  if (!scan) return scan;
  if (Status checked = check_coordinates(file, scan.value()); !checked) return checked.error();
  return scan;
}

}  // namespace spoonbill
