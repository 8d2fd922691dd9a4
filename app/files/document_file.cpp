#include "app/files/document_file.h"

#include "engine/exchange/file_format.h"

namespace spoonbill {

Status check_native_name(const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  if (is_cad(format)) {
    return Error{file.string() + ": is a CAD file; make a document of it with `spoonbill convert`"};
  }
  if (is_mesh(format) || is_cloud(format)) {
    return Error{file.string() + ": is a mesh or a scan; fit a surface to it with `spoonbill fit`"};
  }
  return {};
}

Result<Document> read_document_file(const std::filesystem::path& file) {
  if (Status native = check_native_name(file); !native) return native.error();
  return read_document(file);
}

}  // namespace spoonbill
