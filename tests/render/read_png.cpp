#include "tests/render/read_png.h"

#include <stb_image.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

#include "engine/base/file.h"

namespace spoonbill {
namespace {

constexpr std::array<std::uint8_t, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr int largest_side_px = 16384;

}  // namespace

Result<Image> read_png(const std::filesystem::path& path) {
  const auto bytes = read_file(path, std::size_t{256} << 20);
  if (!bytes) return bytes.error();
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes->data());
  if (bytes->size() < signature.size() || std::memcmp(data, signature.data(), signature.size()) != 0) {
    return Error{ErrorCode::malformed, path.string() + ": not a PNG file"};
  }
  const int length = static_cast<int>(bytes->size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, length, &width, &height, &channels) == 0 || width > largest_side_px ||
      height > largest_side_px) {
    return Error{ErrorCode::malformed, path.string() + ": broken PNG header, or a side above " +
                                           std::to_string(largest_side_px) + " pixels"};
  }
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(data, length, &width, &height, &channels, 4), &stbi_image_free);
  if (!pixels)
    return Error{ErrorCode::malformed, path.string() + ": broken PNG file: " + stbi_failure_reason()};
  Image image;
  image.resize(width, height);
  std::memcpy(image.rgba.data(), pixels.get(), image.rgba.size());
  return image;
}

}  // namespace spoonbill
