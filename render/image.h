// Pictures in memory and their PNG files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/result.h"

namespace spoonbill {

// A picture: 8-bit sRGB with alpha, top row first.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height bytes, row by row

  void resize(int width_px, int height_px) {
    width = width_px;
    height = height_px;
    rgba.resize(row_bytes() * static_cast<std::size_t>(height));
  }
  std::size_t row_bytes() const { return 4 * static_cast<std::size_t>(width); }
  std::uint8_t* pixel(int x, int y) {
    return rgba.data() + row_bytes() * static_cast<std::size_t>(y) + 4 * static_cast<std::size_t>(x);
  }
  const std::uint8_t* pixel(int x, int y) const {
    return rgba.data() + row_bytes() * static_cast<std::size_t>(y) + 4 * static_cast<std::size_t>(x);
  }

  friend bool operator==(const Image&, const Image&) = default;
};

// Divides the colours of a picture with premultiplied alpha by their alpha, as PNG files store them.
void make_alpha_straight(Image& image);

// Flips the picture vertically in place, for pixels from GL, which stores the bottom row first.
void flip_rows(Image& image);

// Encodes pictures as PNG files, reusing its working memory. Use one encoder per thread. The same picture
// gives the same bytes on one machine and the same pixels on all.
class PngEncoder {
 public:
  PngEncoder();

  // Returns the bytes of the file, valid until the next call. An opaque picture is stored without alpha.
  // Errors: an empty picture, a side above 16384 pixels.
  Result<std::span<const std::uint8_t>> encode(const Image& image);

 private:
  void filter(const Image& image, int channels);
  void append_chunk(const char* type, std::span<const std::uint8_t> data);

  Result<std::size_t> compress();  // compresses the filtered rows; returns the size in bytes

  std::vector<std::uint8_t> deflate_memory_;
  std::vector<std::uint8_t> filtered_;
  std::vector<std::uint8_t> compressed_;
  std::vector<std::uint8_t> file_;
};

// Encodes a picture and writes it with write_file(). Errors name the path.
Status write_png(const std::filesystem::path& path, const Image& image, PngEncoder& encoder,
                 Durability durability, const OutputOptions& options = {});

// Writes a single picture, which is on the disk when the function returns.
Status write_png(const std::filesystem::path& path, const Image& image, const OutputOptions& options = {});

}  // namespace spoonbill
