#include "render/passes/background_pass.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace spoonbill {
namespace {

constexpr double bottom_srgb[3] = {238.0, 238.5, 239.0};
constexpr double top_srgb[3] = {196.0, 200.0, 205.0};

// Ordered dithering from row to row hides the steps of eight bits; along a row the colour stays one, so that
// PNG files are small and soon written.
constexpr int pattern_rows = 8;
constexpr int pattern[pattern_rows] = {0, 4, 2, 6, 1, 5, 3, 7};

std::uint8_t dithered(double value, int row) {
  const double threshold = (pattern[row % pattern_rows] + 0.5) / pattern_rows;
  return static_cast<std::uint8_t>(std::floor(value + threshold));
}

// RGBA8, bottom row first.
std::vector<std::uint8_t> gradient(int width_px, int height_px) {
  std::vector<std::uint8_t> texels;
  texels.reserve(4 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  for (int y = 0; y < height_px; ++y) {
    const double t = (y + 0.5) / height_px;
    const double share = t * t * (3.0 - 2.0 * t);
    std::uint8_t colour[4] = {0, 0, 0, 255};
    // The channels step in rows of their own, or the rows would show.
    for (int c = 0; c < 3; ++c) {
      colour[c] = dithered(bottom_srgb[c] + share * (top_srgb[c] - bottom_srgb[c]), y + 3 * c);
    }
    for (int x = 0; x < width_px; ++x) texels.insert(texels.end(), colour, colour + 4);
  }
  return texels;
}

}  // namespace

void BackgroundPass::build(int width_px, int height_px) {
  picture_ = make_texture(*gl_);
  gl_->BindTexture(GL_TEXTURE_2D, picture_.id());
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_px, height_px, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  gradient(width_px, height_px).data());
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  framebuffer_ = make_framebuffer(*gl_);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_.id(), 0);
  width_px_ = width_px;
  height_px_ = height_px;
}

void BackgroundPass::draw(const RenderTarget& target) {
  const int width = target.width_px(), height = target.height_px();
  if (width != width_px_ || height != height_px_) build(width, height);
  target.begin_frame();
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  gl_->BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace spoonbill
