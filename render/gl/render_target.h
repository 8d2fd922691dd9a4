// The picture being drawn, in two layers.
//
// The scene layer has 0 or 4 samples per pixel and is transparent where nothing was drawn. The frame layer
// receives the background, the scene and the interface, and pixels are read from it. Shaders compute in
// linear light and encode to sRGB themselves, because an sRGB target would encode every sample.
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

class RenderTarget {
 public:
  // Creates the layers. Errors: sample counts other than 0 and 4, sizes that the context does not support.
  static Result<RenderTarget> make(const GlFunctions& gl, int width_px, int height_px, int samples);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  int samples() const { return samples_; }

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

  // Copies the frame to the framebuffer of the window.
  void copy_to_window() const;

 private:
  RenderTarget(const GlFunctions& gl, int width_px, int height_px, int samples);
  Status check(GLuint framebuffer) const;

  const GlFunctions* gl_;
  int width_px_;
  int height_px_;
  int samples_;
  bool packs_top_row_first_ = false;  // true if GL can flip the rows while reading
  GlHandle scene_colour_;
  GlHandle scene_depth_;
  GlHandle scene_;
  GlHandle frame_colour_;
  GlHandle frame_;
};

}  // namespace spoonbill
