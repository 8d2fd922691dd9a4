#include "render/contact_sheet.h"

#include <stb_truetype.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/file.h"
#include "render/colour.h"

namespace spoonbill {

namespace {

constexpr std::uint8_t paper = 250;

const std::array<float, 256>& srgb8_to_linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (int i = 0; i < 256; ++i) {
      values[i] = srgb8_to_linear(i);
    }
    return values;
  }();
  return table;
}

std::uint8_t linear_to_srgb8(float linear) {
  const float s = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(std::clamp(s, 0.0f, 1.0f) * 255.0f));
}

// Returns the length of the overlap between the source pixel [i, i + 1) and the target cell [start, end).
float overlap(int i, double start, double end) {
  return static_cast<float>(std::min(end, i + 1.0) - std::max(start, static_cast<double>(i)));
}

void shrink_pixel(const Image& image, double x0, double x1, double y0, double y1, std::uint8_t* out) {
  const auto& linear = srgb8_to_linear_table();
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
  for (int c = 0; c < 3; ++c) out[c] = linear_to_srgb8(sum[c] / weights);
  out[3] = static_cast<std::uint8_t>(std::lround(sum[3] / weights));
}

void paste(Image& sheet, const Image& picture, int x0, int y0) {
  const int rows = std::min(picture.height, sheet.height - y0);
  for (int y = 0; y < rows; ++y) {
    std::memcpy(sheet.pixel(x0, y0 + y), picture.pixel(0, y), picture.row_bytes());
  }
}

constexpr int ink = 40;
constexpr std::size_t caption_font_bytes_limit = std::size_t{256} << 20;

struct Glyph {
  int width = 0, height = 0, left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};

// Initialises the font. The font keeps a pointer to the bytes.
bool read_font(const std::string& bytes, stbtt_fontinfo& font) {
  return stbtt_InitFont(&font, reinterpret_cast<const unsigned char*>(bytes.data()), 0) != 0;
}

Glyph rasterise(const stbtt_fontinfo& font, int codepoint, float scale, float shift) {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  stbtt_GetCodepointBitmapBoxSubpixel(&font, codepoint, scale, scale, shift, 0, &x0, &y0, &x1, &y1);
  Glyph glyph{x1 - x0, y1 - y0, x0, y0, {}};
  glyph.coverage.resize(static_cast<std::size_t>(glyph.width) * static_cast<std::size_t>(glyph.height));
  if (!glyph.coverage.empty()) {
    stbtt_MakeCodepointBitmapSubpixel(&font, glyph.coverage.data(), glyph.width, glyph.height, glyph.width,
                                      scale, scale, shift, 0, codepoint);
  }
  return glyph;
}

void stamp(Image& image, const Glyph& glyph, int x0, int y0) {
  for (int y = 0; y < glyph.height; ++y) {
    for (int x = 0; x < glyph.width; ++x) {
      const int px = x0 + x, py = y0 + y;
      if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
      const int cover = glyph.coverage[static_cast<std::size_t>(y * glyph.width + x)];
      std::uint8_t* pixel = image.pixel(px, py);
      for (int c = 0; c < 3; ++c) {
        pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - cover) + ink * cover) / 255);
      }
    }
  }
}

// A font that draws text on a picture without GL.
class CaptionFont {
 public:
  // Loads a TrueType file. Errors: a file that is missing or not a TrueType font.
  static Result<CaptionFont> load(const std::string& path);

  // Draws one line of Latin-1 text in dark ink. (x_px, y_px) is the top left corner of the line and size_px
  // its height. The text is clipped at the edges of the picture.
  void draw(Image& image, const std::string& text, int x_px, int y_px, int size_px) const;

 private:
  std::string file_;  // contents of the file
};

Result<CaptionFont> CaptionFont::load(const std::string& path) {
  auto file = read_file(path, caption_font_bytes_limit);
  CaptionFont font;
  if (file) font.file_ = std::move(file).value();
  stbtt_fontinfo info;
  if (font.file_.size() < 16 || !read_font(font.file_, info)) {
    return Error{ErrorCode::unreadable,
                 path + ": no readable TrueType font; install fonts-roboto-unhinted or name another file"};
  }
  return font;
}

void CaptionFont::draw(Image& image, const std::string& text, int x_px, int y_px, int size_px) const {
  SPOONBILL_ASSERT(size_px > 0);
  stbtt_fontinfo font;
  read_font(file_, font);
  const float scale = stbtt_ScaleForPixelHeight(&font, static_cast<float>(size_px));
  int ascent = 0, descent = 0, gap = 0;
  stbtt_GetFontVMetrics(&font, &ascent, &descent, &gap);
  const int baseline = y_px + static_cast<int>(std::lround(static_cast<float>(ascent) * scale));
  float pen = static_cast<float>(x_px);
  for (const char letter : text) {
    const int codepoint = static_cast<unsigned char>(letter);
    const float whole = std::floor(pen);
    const Glyph glyph = rasterise(font, codepoint, scale, pen - whole);
    stamp(image, glyph, static_cast<int>(whole) + glyph.left, baseline + glyph.top);
    int advance = 0, bearing = 0;
    stbtt_GetCodepointHMetrics(&font, codepoint, &advance, &bearing);
    pen += static_cast<float>(advance) * scale;
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
  if (cells_.empty()) return Error{ErrorCode::too_few, "a contact sheet needs at least one frame"};
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
