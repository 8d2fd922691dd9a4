#include "render/read_bytes.h"

#include <fstream>
#include <system_error>

namespace spoonbill {

Result<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& path) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{256} << 20;
  std::error_code failure;
  // A folder opens like a file and fails only when read.
  if (!std::filesystem::is_regular_file(path, failure)) return Error{path.string() + ": no such file"};
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure || size > most_bytes) return Error{path.string() + ": unreadable, or above 256 MiB"};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    return Error{path.string() + ": cannot be read; check its permissions"};
  }
  return bytes;
}

}  // namespace spoonbill
