// The internal commands read-mesh and read-points: the child processes that parse meshes and point clouds.
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <variant>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/reader_confinement.h"
#include "engine/base/file.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/frame_stream.h"
#include "engine/exchange/mesh_import.h"
#include "engine/exchange/scans/ply_file.h"
#include "engine/exchange/scans/point_cloud.h"

namespace spoonbill {
namespace {

Result<TriangleMesh> import_within_memory(const std::filesystem::path& file) {
  try {
    return import_mesh(file);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::too_many, bad_allocation};
  }
}

Status send_mesh(const std::filesystem::path& file, Console& console) {
  const auto mesh = import_within_memory(file);
  if (mesh) {
    write_mesh(console.out, mesh.value());
    return {};
  }
  write_failure(console.out, mesh.error().message);
  return mesh.error().in(file.string());
}

// Sends the mesh or the point cloud that a PLY file contains.
Status send_ply(const std::string& bytes, Console& console) {
  auto content = parse_ply(bytes);
  if (!content) return content.error();
  if (auto* mesh = std::get_if<FileMesh>(&content.value())) {
    write_mesh(console.out, {std::move(mesh->vertices), std::move(mesh->triangles)});
  } else {
    write_cloud(console.out, std::get<PointCloud>(content.value()));
  }
  return {};
}

// Sends the point cloud of a file, or the mesh of a PLY file. If an OBJ file contains faces, sends
// FrameKind::faces alone, which reports that the file is a mesh.
Status send_cloud(const std::filesystem::path& file, Console& console) {
  const FileFormat format = format_from_name(file);
  const auto bytes = read_file(file, point_file_bytes_limit);
  if (!bytes) return bytes.error();
  if (format == FileFormat::ply) return send_ply(bytes.value(), console);
  if (format == FileFormat::obj && obj_has_faces(bytes.value())) {
    write_frame(console.out, FrameKind::faces, {});
    return {};
  }
  const auto cloud = points_of(bytes.value(), file);
  if (!cloud) return cloud.error();
  write_cloud(console.out, cloud.value());
  return {};
}

// Removes "FILE: " from the start of the message. The parent adds the name itself, and a long name would
// leave no room for the rest of the message.
std::string without_name(const std::string& message, const std::filesystem::path& file) {
  const std::string name = file.string() + ": ";
  return message.starts_with(name) ? message.substr(name.size()) : message;
}

Status send_points(const std::filesystem::path& file, Console& console) {
  try {
    Status sent = send_cloud(file, console);
    if (!sent) write_failure(console.out, without_name(sent.error().message, file));
    return sent;
  } catch (const std::bad_alloc&) {
    write_failure(console.out, bad_allocation);
    return Error{ErrorCode::too_many, file.string() + ": " + bad_allocation};
  }
}

CommandEntry add_reader(OptionSet root, const char* name, const char* description, const char* file_help,
                        Status (*send)(const std::filesystem::path& file, Console& console)) {
  auto file = std::make_shared<std::filesystem::path>();
  const OptionSet parser = root.add_command(name, description);
  parser.add_option("FILE", *file, file_help).require();
  return {parser, [file, send](Console& console) {
            if (Status confined = confine_reader(); !confined) {
              write_failure(console.out, confined.error());
              return confined;
            }
            return send(*file, console);
          }};
}

}  // namespace

CommandEntry add_read_mesh(OptionSet root) {
  return add_reader(root, "read-mesh", "Send the triangles of a mesh file to the parent process",
                    "Mesh (.obj, .stl or .ply)", send_mesh);
}

CommandEntry add_read_points(OptionSet root) {
  return add_reader(root, "read-points", "Send the points of a cloud to the parent process",
                    "Cloud (.ply, .pcd, .xyz, .txt, .csv, .asc, .pts or .obj)", send_points);
}

}  // namespace spoonbill
