#include <filesystem>
#include <memory>
#include <new>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/foreign_child.h"
#include "engine/exchange/frame_stream.h"
#include "engine/exchange/mesh_import.h"

namespace spoonbill {
namespace {

Result<TriangleMesh> import(const std::filesystem::path& file) {
  try {
    return import_mesh(file);
  } catch (const std::bad_alloc&) {
    return Error{bad_allocation};
  }
}

Status read_mesh(const std::filesystem::path& file, Console& console) {
  const auto mesh = import(file);
  if (mesh) {
    write_mesh(console.out, mesh.value());
    return {};
  }
  write_failure(console.out, mesh.error().message);
  return Error{file.string() + ": " + mesh.error().message};
}

}  // namespace

CommandEntry add_read_mesh(OptionSet root) {
  auto file = std::make_shared<std::filesystem::path>();
  const OptionSet parser =
      root.add_command("read-mesh", "Hand a mesh file's triangles to the program itself");
  parser.hide();
  parser.add_option("FILE", *file, "A mesh (.obj, .stl or .ply)").require();
  return {parser, [file](Console& console) {
            end_with_parent();
            return read_mesh(*file, console);
          }};
}

}  // namespace spoonbill
