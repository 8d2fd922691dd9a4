#include "render/image/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "render/image/caption.h"

namespace spoonbill {
namespace {

constexpr std::uint8_t paper = 250;

const std::array<float, 256>& linear_of_srgb() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (int i = 0; i < 256; ++i) {
      const double s = i / 255.0;
      values[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table;
}

std::uint8_t srgb_of_linear(float linear) {
  const float s = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(std::clamp(s, 0.0f, 1.0f) * 255.0f));
}

// The part of the source interval [i, i + 1) that the target cell [start, end) covers.
float overlap(int i, double start, double end) {
  return static_cast<float>(std::min(end, i + 1.0) - std::max(start, static_cast<double>(i)));
}

void shrink_pixel(const Image& image, double x0, double x1, double y0, double y1, std::uint8_t* out) {
  const auto& linear = linear_of_srgb();
  std::array<float, 4> sum{};
  float weights = 0.0f;
  for (int y = static_cast<int>(y0); y < std::min(image.height, static_cast<int>(std::ceil(y1))); ++y) {
    for (int x = static_cast<int>(x0); x < std::min(image.width, static_cast<int>(std::ceil(x1))); ++x) {
      const float weight = overlap(x, x0, x1) * overlap(y, y0, y1);
      const std::uint8_t* in = image.pixel(x, y);
      for (int c = 0; c < 3; ++c) sum[c] += weight * linear[in[c]];
      sum[3] += weight * static_cast<float>(in[3]);
      weights += weight;
    }
  }
  for (int c = 0; c < 3; ++c) out[c] = srgb_of_linear(sum[c] / weights);
  out[3] = static_cast<std::uint8_t>(std::lround(sum[3] / weights));
}

void paste(Image& sheet, const Image& picture, int x0, int y0) {
  const int rows = std::min(picture.height, sheet.height - y0);
  for (int y = 0; y < rows; ++y) {
    std::memcpy(sheet.pixel(x0, y0 + y), picture.pixel(0, y), picture.row_bytes());
  }
}

}  // namespace

Image shrink(const Image& image, int width_px, int height_px) {
  Image small;
  small.resize(width_px, height_px);
  const double step_x = static_cast<double>(image.width) / width_px;
  const double step_y = static_cast<double>(image.height) / height_px;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      shrink_pixel(image, x * step_x, (x + 1) * step_x, y * step_y, (y + 1) * step_y, small.pixel(x, y));
    }
  }
  return small;
}

void ContactSheet::add(const Image& frame, std::string caption) {
  const int width = std::min(layout_.cell_width_px, frame.width);
  const int height =
      cells_.empty()
          ? std::max(1,
                     static_cast<int>(std::lround(static_cast<double>(frame.height) * width / frame.width)))
          : cells_.front().picture.height;
  cells_.push_back({shrink(frame, width, height), std::move(caption)});
}

Result<Image> ContactSheet::compose() const {
  if (cells_.empty()) return Error{"a contact sheet needs at least one frame"};
  const bool captions = layout_.caption_px > 0;
  Result<CaptionFont> font = captions ? CaptionFont::load(layout_.caption_font_path) : CaptionFont();
  if (!font) return font.error();

  const int count = static_cast<int>(cells_.size());
  const int columns = std::clamp(layout_.columns, 1, count);
  const int rows = (count + columns - 1) / columns;
  const int margin = layout_.margin_px;
  const int cell_width = cells_.front().picture.width + margin;
  const int caption_height = captions ? layout_.caption_px + margin / 2 : 0;
  const int cell_height = cells_.front().picture.height + caption_height + margin;

  Image sheet;
  sheet.resize(columns * cell_width + margin, rows * cell_height + margin);
  std::fill(sheet.rgba.begin(), sheet.rgba.end(), paper);
  for (std::size_t i = 3; i < sheet.rgba.size(); i += 4) sheet.rgba[i] = 255;
  for (int i = 0; i < count; ++i) {
    const Cell& cell = cells_[static_cast<std::size_t>(i)];
    const int x = margin + (i % columns) * cell_width;
    const int y = margin + (i / columns) * cell_height;
    paste(sheet, cell.picture, x, y);
    if (captions) {
      font->draw(sheet, cell.caption, x, y + cell.picture.height + margin / 4, layout_.caption_px);
    }
  }
  return sheet;
}

}  // namespace spoonbill
