// Draws lines of constant width on the screen, with smooth edges.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/instanced_quads.h"
#include "render/gl/program.h"
#include "render/overlay/line.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

class LinePass {
 public:
  static Result<LinePass> make(const GlFunctions& gl);

  // Tests depth after moving the lines by lift_m toward the eye, so that what lies on a surface shows.
  void draw(const FrameView& view, const std::vector<OverlayLine>& lines, float lift_m) const;

 private:
  LinePass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

}  // namespace spoonbill
