// The studio behind the scene: a quiet vertical gradient. It is made once for a size and copied into every
// frame, which costs a tenth of drawing it.
#pragma once

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/render_target.h"

namespace spoonbill {

class BackgroundPass {
 public:
  explicit BackgroundPass(const GlFunctions& gl) : gl_(&gl) {}

  // Writes every pixel of the target's frame and leaves it bound.
  void draw(const RenderTarget& target);

 private:
  void build(int width_px, int height_px);

  const GlFunctions* gl_;
  GlHandle picture_;
  GlHandle framebuffer_;
  int width_px_ = 0, height_px_ = 0;
};

}  // namespace spoonbill
