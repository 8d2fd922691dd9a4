// Draws the body's surfaces in the studio's light.
#pragma once

#include <vector>

#include "engine/result.h"
#include "render/gl/functions.h"
#include "render/gl/program.h"
#include "render/passes/frame_view.h"
#include "render/passes/shadow_pass.h"
#include "render/passes/surface_buffers.h"
#include "render/surface_look.h"

namespace spoonbill {

class SurfacePass {
 public:
  static Result<SurfacePass> make(const GlFunctions& gl);

  // Opaque looks write depth; translucent ones are blended, back faces first, and belong after the ground.
  // `shadow` is null when shadows are off.
  void draw(const FrameView& view, const std::vector<SurfaceBuffers>& surfaces, const SurfaceLook& look,
            const ToolSphere& tool, const ShadowPass* shadow) const;

 private:
  SurfacePass(const GlFunctions& gl, Program program) : gl_(&gl), program_(std::move(program)) {}
  void set_uniforms(const FrameView& view, const SurfaceLook& look, const ToolSphere& tool,
                    const ShadowPass* shadow) const;

  const GlFunctions* gl_;
  Program program_;
};

}  // namespace spoonbill
