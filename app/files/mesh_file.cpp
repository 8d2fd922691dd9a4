#include "app/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "app/files/foreign_child.h"
#include "engine/base/file.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr std::size_t file_bytes_limit = std::size_t{512} << 20;

const char* const smaller = "reduce the mesh";

std::string upper_case_name(FileFormat format) {
  std::string name(usual_ending(format));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return name;
}

ForeignTask task_for(const std::filesystem::path& file) {
  ForeignTask task{file, "mesh", smaller};
  task.refusal = [format = upper_case_name(format_from_name(file))](const std::string& reason) {
    return "cannot be read as " + format + " (" + ForeignTask::printable(reason) + "); export it anew";
  };
  return task;
}

Status check_counts(const std::filesystem::path& file, const MeshCounts& counts, std::size_t limit) {
  if (counts.triangles > limit || counts.vertices > 3 * limit) {
    return Error{file.string() + ": has " + std::to_string(counts.triangles) + " triangles with " +
                 std::to_string(counts.vertices) + " vertices, more than the " + std::to_string(limit) +
                 " triangles that are read; reduce the mesh"};
  }
  return {};
}

}  // namespace

Result<MeshFile> read_mesh_file(const std::filesystem::path& file, const MeshReading& reading) {
  const FileFormat format = format_from_name(file);
  if (!is_mesh(format)) {
    return Error{file.string() + ": is no mesh by its name; .obj, .stl and .ply are read"};
  }
  if (Status status = check_file(file, file_bytes_limit, smaller); !status) {
    return status.error();
  }
  auto child = ForeignChild::start(
      task_for(file), {reading.program.string(), "read-mesh", "--", file.string()}, reading.patience);
  if (!child) return child.error();
  const auto head = child->next();
  if (!head) return head.error();
  MeshCounts counts;
  if (head->kind != FrameKind::mesh || head->bytes < sizeof counts) return child->not_in_form();
  if (Status got = child->read(&counts, sizeof counts); !got) return got.error();
  if (Status status = check_counts(file, counts, reading.triangle_limit); !status) return status.error();
  if (head->bytes != mesh_frame_bytes(counts)) return child->not_in_form();
  MeshFile result;
  result.unit = reading.unit.value_or(format == FileFormat::ply ? metre : millimetre);
  result.mesh.vertices_m.resize(counts.vertices);
  result.mesh.triangles.resize(counts.triangles);
  if (Status got = child->read(result.mesh.vertices_m); !got) return got.error();
  if (Status got = child->read(result.mesh.triangles); !got) return got.error();
  for (Vector3& vertex : result.mesh.vertices_m) vertex *= result.unit.metres;
  return result;
}

}  // namespace spoonbill
