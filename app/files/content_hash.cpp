#include "app/files/content_hash.h"

#include <functional>

#include "engine/base/file.h"

namespace spoonbill {
namespace {

// Limit on the size of a file in bytes, far above the size of the largest document.
constexpr std::size_t bytes_limit = std::size_t{1} << 30;

}  // namespace

std::uint64_t content_hash(std::string_view content) {
  return std::hash<std::string_view>{}(content);
}

std::optional<std::uint64_t> file_content_hash(const std::filesystem::path& file) {
  const auto content = read_file(file, bytes_limit);
  if (!content) return std::nullopt;
  return content_hash(content.value());
}

}  // namespace spoonbill
