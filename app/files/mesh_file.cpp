#include "app/files/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "app/files/foreign_file.h"
#include "app/files/mesh_stream.h"
#include "app/process/child_output.h"
#include "engine/exchange/mesh_import.h"

namespace spoonbill {
namespace {

constexpr std::size_t file_bytes_limit = std::size_t{512} << 20;

std::string format_name(const std::filesystem::path& file) {
  std::string name = format_of(file);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return name;
}

// Why there is no mesh, after the child has ended or was ended.
Error explain(const std::filesystem::path& file, ChildOutput& child, const MeshReading& reading) {
  return explain_end(file, child.wait(), reading.patience, "mesh", "reduce the mesh");
}

Error failure_of_import(const std::filesystem::path& file, ChildOutput& child, std::uint64_t length,
                        const MeshReading& reading) {
  std::string reason(std::min(length, MeshStreamHead::longest_failure), ' ');
  if (!child.read(reason.data(), reason.size())) return explain(file, child, reading);
  if (reason.find("bad alloc") != std::string::npos || reason.find("bad_alloc") != std::string::npos) {
    return Error{file.string() + ": reading it takes more than " +
                 std::to_string(ChildOutput::memory_limit >> 30) + " GiB; reduce the mesh"};
  }
  std::replace_if(
      reason.begin(), reason.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  return Error{file.string() + ": cannot be read as " + format_name(file) + " (" + reason +
               "); export it anew"};
}

Status check_counts(const std::filesystem::path& file, const MeshStreamHead& head, std::size_t limit) {
  if (head.second_count > limit || head.first_count > 3 * limit) {
    return Error{file.string() + ": has " + std::to_string(head.second_count) + " triangles with " +
                 std::to_string(head.first_count) + " vertices, more than the " + std::to_string(limit) +
                 " triangles that are read; reduce the mesh"};
  }
  return {};
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
  return is_mesh_name(file);
}

Result<MeshFile> read_mesh_file(const std::filesystem::path& file, const MeshReading& reading) {
  if (!is_mesh_name(file)) {
    return Error{file.string() + ": is no mesh by its name; .obj, .stl and .ply are read"};
  }
  if (Status status = check_foreign_file(file, file_bytes_limit, "reduce the mesh"); !status) {
    return status.error();
  }
  auto child =
      ChildOutput::start({reading.program.string(), "read-mesh", "--", file.string()}, reading.patience);
  if (!child) return Error{file.string() + ": " + child.error().message};

  MeshStreamHead head;
  if (!child->read(&head, sizeof head)) return explain(file, child.value(), reading);
  if (head.letters == MeshStreamHead::failure) {
    return failure_of_import(file, child.value(), head.first_count, reading);
  }
  if (head.letters != MeshStreamHead::mesh) {
    return Error{file.string() + ": the reader did not answer in its own form; build the program anew"};
  }
  if (Status status = check_counts(file, head, reading.triangle_limit); !status) return status.error();
  MeshFile result;
  result.unit = reading.unit.value_or(format_of(file) == "ply" ? metre : millimetre);
  result.mesh.vertices_m.resize(head.first_count);
  result.mesh.triangles.resize(head.second_count);
  if (!child->read(result.mesh.vertices_m.data(), head.first_count * sizeof(Vector3)) ||
      !child->read(result.mesh.triangles.data(), head.second_count * sizeof(TriangleCorners))) {
    return explain(file, child.value(), reading);
  }
  for (Vector3& vertex : result.mesh.vertices_m) vertex *= result.unit.metres;
  return result;
}

}  // namespace spoonbill
