// PNG files. The same picture gives the same bytes on one machine, and the same pixels on all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/result.h"
#include "render/image/image.h"

namespace spoonbill {

// Encodes pictures one after another in its own working memory: one encoder a thread.
class PngEncoder {
 public:
  PngEncoder();

  // The bytes of the file, valid until the next call. An opaque picture is stored without alpha. Refused: an
  // empty picture, a side above 16384 pixels.
  Result<std::span<const std::uint8_t>> encode(const Image& image);

 private:
  void filter(const Image& image, int channels);
  void append_chunk(const char* type, std::span<const std::uint8_t> data);

  Result<std::size_t> compress();  // the filtered rows; the size in bytes

  std::vector<std::uint8_t> deflate_memory_;
  std::vector<std::uint8_t> filtered_;
  std::vector<std::uint8_t> compressed_;
  std::vector<std::uint8_t> file_;
};

// Encodes and writes a file as write_file() does. The error names the path.
Status write_png(const std::filesystem::path& path, const Image& image, PngEncoder& encoder,
                 Durability durability);

// As above, for a single picture, which is on the disk when this returns.
Status write_png(const std::filesystem::path& path, const Image& image);

}  // namespace spoonbill
