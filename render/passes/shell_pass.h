// Draws translucent spheres with their outline, where no body hides them.
#pragma once

#include <vector>

#include "render/gl/functions.h"
#include "render/gl/instanced_quads.h"
#include "render/gl/program.h"
#include "render/overlay/contact_stage.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

class ShellPass {
 public:
  static Result<ShellPass> make(const GlFunctions& gl);

  // Sorts them from back to front.
  void draw(const FrameView& view, std::vector<OverlayShell>& shells) const;

 private:
  ShellPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

}  // namespace spoonbill
