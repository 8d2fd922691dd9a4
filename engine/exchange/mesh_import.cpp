#include "engine/exchange/mesh_import.h"

#include <utility>
#include <variant>

#include "engine/base/file.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/scans/obj_file.h"
#include "engine/exchange/scans/ply_file.h"
#include "engine/exchange/scans/stl_file.h"

namespace spoonbill {
namespace {

Result<FileMesh> parse_ply_mesh(std::string_view bytes) {
  auto content = parse_ply(bytes);
  if (!content) return content.error();
  if (auto* mesh = std::get_if<FileMesh>(&content.value())) return std::move(*mesh);
  return Error{ErrorCode::too_few, "has no triangles; export a surface mesh"};
}

}  // namespace

Result<TriangleMesh> import_mesh(const std::filesystem::path& file) {
  const auto bytes = read_file(file, point_file_bytes_limit);
  if (!bytes) return bytes.error();
  const FileFormat format = format_from_name(file);
  auto mesh = format == FileFormat::stl   ? parse_stl(bytes.value())
              : format == FileFormat::obj ? parse_obj_mesh(bytes.value())
                                          : parse_ply_mesh(bytes.value());
  if (!mesh) return mesh.error();
  return TriangleMesh{std::move(mesh->vertices), std::move(mesh->triangles)};
}

}  // namespace spoonbill
