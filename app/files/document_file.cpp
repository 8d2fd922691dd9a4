#include "app/files/document_file.h"

#include "app/files/cad_file.h"
#include "app/files/mesh_file.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {

Status check_native_name(const std::filesystem::path& file) {
  if (is_cad_file(file)) {
    return Error{file.string() + ": is a CAD file; make a document of it with `spoonbill convert`"};
  }
  if (is_mesh_file(file) || is_point_name(file)) {
    return Error{file.string() + ": is a mesh or a scan; fit a surface to it with `spoonbill fit`"};
  }
  return {};
}

Result<Document> read_document_file(const std::filesystem::path& file) {
  if (Status native = check_native_name(file); !native) return native.error();
  return read_document(file);
}

}  // namespace spoonbill
