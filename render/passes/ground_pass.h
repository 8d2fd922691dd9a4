// Lays the shadows over the ground. The ground itself is no surface: the background shows through it, so that
// it has no edge.
#pragma once

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"
#include "render/passes/frame_view.h"
#include "render/passes/shadow_pass.h"

namespace spoonbill {

class GroundPass {
 public:
  static Result<GroundPass> make(const GlFunctions& gl);

  // Darkens what lies behind the ground; nothing when the eye is below it. After the background.
  void draw_shadow(const FrameView& view, const ShadowPass& shadow) const;

 private:
  GroundPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
};

}  // namespace spoonbill
