// Draws marks: flat squares, discs and diamonds that face the eye, with smooth edges and a darker border.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/instanced_quads.h"
#include "render/gl/program.h"
#include "render/overlay/mark.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

class MarkPass {
 public:
  static Result<MarkPass> make(const GlFunctions& gl);

  // Each mark is as large as its radius asks for, at most seven pixels of radius (before the interface
  // scale). Tests depth after moving the marks toward the eye, by lift_m or a little more than their own
  // size.
  void draw(const FrameView& view, const std::vector<OverlayMark>& marks, float lift_m) const;

 private:
  MarkPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

}  // namespace spoonbill
