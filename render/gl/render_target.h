// The picture being drawn, in two layers: the scene with 0 or 4 samples, transparent where nothing was drawn,
// and the frame, on which the scene is laid over its background, then the interface, and from which pixels
// are read. Shaders compute in linear light and encode to sRGB themselves: a target that encodes would do so
// for every sample.
#pragma once

#include <span>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/image/image.h"

namespace spoonbill {

// Pixels as GL counts them: the origin at the lower left.
struct PixelArea {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
};

class RenderTarget {
 public:
  // Refused: sample counts other than 0 and 4, sizes that the context cannot hold.
  static Result<RenderTarget> make(const GlFunctions& gl, int width_px, int height_px, int samples);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  int samples() const { return samples_; }

  // Drawing goes to the scene, which is transparent and of clear depth in these areas. What lies outside them
  // is of an earlier frame.
  void begin_scene(std::span<const PixelArea> areas) const;

  // Drawing goes to the frame, which has no depth. Every pixel must be written first.
  void begin_frame() const;

  // The scene's colours, premultiplied: a multisample texture, or a plain one without samples.
  GLuint scene_texture() const { return scene_colour_.id(); }
  GLenum scene_texture_kind() const { return samples_ > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D; }

  // Copies the frame, top row first.
  void read(Image& image) const;

  // Copies the frame to the window's framebuffer.
  void copy_to_window() const;

 private:
  RenderTarget(const GlFunctions& gl, int width_px, int height_px, int samples);
  Status check(GLuint framebuffer) const;

  const GlFunctions* gl_;
  int width_px_;
  int height_px_;
  int samples_;
  bool packs_top_row_first_ = false;  // what is read
  GlHandle scene_colour_;
  GlHandle scene_depth_;
  GlHandle scene_;
  GlHandle frame_colour_;
  GlHandle frame_;
};

}  // namespace spoonbill
