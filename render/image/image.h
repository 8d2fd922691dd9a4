// A picture in memory: 8-bit sRGB with alpha, top row first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spoonbill {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height, row by row

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

// Turns the picture upside down, in place: GL keeps the bottom row first.
void flip_rows(Image& image);

}  // namespace spoonbill
