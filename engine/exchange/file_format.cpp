#include "engine/exchange/file_format.h"

#include <string>

#include "engine/base/file.h"
#include "engine/exchange/json.h"

namespace spoonbill {
namespace {

constexpr std::size_t bytes_limit = std::size_t{64} << 20;

// Returns true if the file is a recording. Only its first bytes are read, because a recording may be long or
// truncated.
bool starts_like_recording(const std::filesystem::path& file) {
  return read_first_bytes(file, 64).find("\"spoonbill_recording\"") != std::string::npos;
}

}  // namespace

Result<FileFormat> find_native_format(const std::filesystem::path& file) {
  if (starts_like_recording(file)) return FileFormat::recording;
  const auto text = read_file(file, bytes_limit);
  if (!text) return text.error();
  const auto json = parse_json(text.value(), file.string());
  if (!json) return json.error();
  if (json->is_object()) {
    if (json->contains("spoonbill_document")) return FileFormat::document;
    if (json->contains("spoonbill_script")) return FileFormat::script;
    if (json->contains("youngs_modulus_pa")) return FileFormat::material;
  }
  return Error{ErrorCode::unsupported,
               file.string() + ": is not a Spoonbill document, recording, script or material"};
}

}  // namespace spoonbill
