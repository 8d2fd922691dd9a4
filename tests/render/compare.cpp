#include "tests/render/compare.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

namespace spoonbill {
namespace {

Status check_sizes(const Image& a, const Image& b) {
  if (a.width == b.width && a.height == b.height) return {};
  const auto size = [](const Image& image) {
    return std::to_string(image.width) + "x" + std::to_string(image.height);
  };
  return Error{ErrorCode::inconsistent,
               "pictures of different sizes cannot be compared: " + size(a) + " and " + size(b)};
}

double block_difference(const Image& a, const Image& b, int x0, int y0) {
  const int x1 = std::min(x0 + comparison_block_px, a.width);
  const int y1 = std::min(y0 + comparison_block_px, a.height);
  std::array<long, 4> sums{};
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* pa = a.pixel(x0, y);
    const std::uint8_t* pb = b.pixel(x0, y);
    for (int i = 0; i < 4 * (x1 - x0); ++i) sums[i & 3] += std::abs(pa[i] - pb[i]);
  }
  const auto pixels = static_cast<double>((x1 - x0) * (y1 - y0));
  return static_cast<double>(*std::max_element(sums.begin(), sums.end())) / pixels;
}

void frame_block(Image& image, const BlockDifference& block) {
  const int x1 = std::min(block.x_px + comparison_block_px, image.width) - 1;
  const int y1 = std::min(block.y_px + comparison_block_px, image.height) - 1;
  constexpr std::array<std::uint8_t, 4> magenta = {255, 0, 255, 255};
  const auto paint = [&](int x, int y) { std::copy(magenta.begin(), magenta.end(), image.pixel(x, y)); };
  for (int x = block.x_px; x <= x1; ++x) paint(x, block.y_px), paint(x, y1);
  for (int y = block.y_px; y <= y1; ++y) paint(block.x_px, y), paint(x1, y);
}

}  // namespace

Result<BlockDifference> worst_block_difference(const Image& expected, const Image& actual) {
  if (Status sizes = check_sizes(expected, actual); !sizes) return sizes.error();
  BlockDifference worst;
  for (int y = 0; y < expected.height; y += comparison_block_px) {
    for (int x = 0; x < expected.width; x += comparison_block_px) {
      const double difference = block_difference(expected, actual, x, y);
      if (difference > worst.worst) worst = {difference, x, y};
    }
  }
  return worst;
}

Result<Image> difference_picture(const Image& expected, const Image& actual) {
  const auto worst = worst_block_difference(expected, actual);
  if (!worst) return worst.error();
  constexpr int amplification = 8;
  Image picture = expected;
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    const int difference = amplification * std::abs(expected.rgba[i] - actual.rgba[i]);
    const bool is_alpha = i % 4 == 3;
    picture.rgba[i] =
        is_alpha ? 255 : static_cast<std::uint8_t>(std::min(255, expected.rgba[i] / 4 + difference));
  }
  if (worst->worst > 0.0) frame_block(picture, worst.value());
  return picture;
}

bool has_panel(const Image& picture) {
  const int first = picture.height / 8, end = picture.height / 3;
  int different = 0;
  for (int y = first; y < end; ++y) {
    const std::uint8_t *left = picture.pixel(2, y), *right = picture.pixel(picture.width - 3, y);
    int largest = 0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(left[c] - right[c]));
    if (largest > 2) ++different;
  }
  return 2 * different > end - first;
}

}  // namespace spoonbill
