// The picture being drawn, in two layers.
//
// The scene layer has 0 or 4 samples per pixel and is transparent where nothing was drawn. It may have fewer
// pixels than the frame, over which it is then stretched. The frame layer receives the background, the scene
// and the interface, and pixels are read from it. Shaders compute in linear light and encode to sRGB
// themselves, because an sRGB target would encode every sample.
#pragma once

#include <span>

#include "engine/base/result.h"
#include "render/gl/pipeline.h"
#include "render/image.h"

namespace spoonbill {

// A rectangle of pixels with the origin of GL, at the lower left.
struct PixelArea {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
};

struct PixelSize {
  int width_px = 0, height_px = 0;

  friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

class RenderTarget {
 public:
  // Creates the layers. The channels of the frame have the order of `channels`, GL_RGBA or GL_BGRA. Errors:
  // sample counts other than 0 and 4, sizes that the context does not support.
  static Result<RenderTarget> make(const GlFunctions& gl, PixelSize frame, PixelSize scene, int samples,
                                   GLenum channels);

  int width_px() const { return frame_size_.width_px; }
  int height_px() const { return frame_size_.height_px; }
  PixelSize scene_size() const { return scene_size_; }
  int samples() const { return samples_; }
  GLenum channels() const { return channels_; }

  // Binds the scene layer and clears its colour and depth in these areas. Pixels outside the areas keep their
  // values from an earlier frame.
  void begin_scene(std::span<const PixelArea> areas) const;

  // Binds the frame layer, which has no depth buffer. Its pixels are not cleared, so the first pass must
  // write all of them.
  void begin_frame() const;
  // Does the same, and makes its pixels transparent.
  void clear_frame() const;

  // Premultiplied colours of the scene: a multisample texture, or an ordinary texture if there are no
  // samples.
  GLuint scene_texture() const { return scene_colour_.id(); }
  GLenum scene_texture_kind() const { return samples_ > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D; }

  // Copies the frame, top row first.
  void read(Image& image) const;

  // Copies the frame to the framebuffer of the window. Mesa's software renderer takes half as long if
  // both have the same order of channels, usually GL_BGRA.
  void copy_to_window() const;

 private:
  RenderTarget(const GlFunctions& gl, PixelSize frame, PixelSize scene, int samples, GLenum channels);
  Status check(GLuint framebuffer) const;

  const GlFunctions* gl_;
  PixelSize frame_size_, scene_size_;
  int samples_;
  GLenum channels_;
  bool packs_top_row_first_ = false;  // true if GL can flip the rows while reading
  GlHandle scene_colour_;
  GlHandle scene_depth_;
  GlHandle scene_;
  GlHandle frame_colour_;
  GlHandle frame_;
};

}  // namespace spoonbill
