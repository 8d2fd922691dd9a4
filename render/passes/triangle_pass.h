// Draws flat triangles that lie on a surface, unlit, their colour's alpha their opacity.
#pragma once

#include <vector>

#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"
#include "render/overlay/contact_stage.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

class TrianglePass {
 public:
  static Result<TrianglePass> make(const GlFunctions& gl);

  // Three corners each; tests depth after moving them by lift_m toward the eye.
  void draw(const FrameView& view, const std::vector<OverlayCorner>& corners, float lift_m) const;

 private:
  TrianglePass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
  GlHandle vertices_;
};

}  // namespace spoonbill
