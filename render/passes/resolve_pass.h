// Averages the scene's samples and lays the result over the frame.
#pragma once

#include <span>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"
#include "render/gl/render_target.h"

namespace spoonbill {

class ResolvePass {
 public:
  static Result<ResolvePass> make(const GlFunctions& gl);

  // Within the areas that the scene was drawn in. The target's frame must be bound.
  void draw(const RenderTarget& target, std::span<const PixelArea> areas) const;

 private:
  ResolvePass(const GlFunctions& gl, Program with_samples, Program without_samples);

  const GlFunctions* gl_;
  Program with_samples_, without_samples_;
  GlHandle vertex_array_;
};

}  // namespace spoonbill
