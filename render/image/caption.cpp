#include "render/image/caption.h"

#include <stb_truetype.h>

#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

constexpr int ink = 40;
constexpr std::size_t font_bytes_limit = std::size_t{256} << 20;

struct Glyph {
  int width = 0, height = 0, left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};

// The font refers to the bytes.
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

}  // namespace

Result<CaptionFont> CaptionFont::load(const std::string& path) {
  auto file = read_file(path, font_bytes_limit);
  CaptionFont font;
  if (file) font.file_ = std::move(file).value();
  stbtt_fontinfo info;
  if (font.file_.size() < 16 || !read_font(font.file_, info)) {
    return Error{path + ": no readable TrueType font; install fonts-roboto-unhinted or name another file"};
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

}  // namespace spoonbill
