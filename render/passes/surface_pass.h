// Draws a body's surface in the studio's light.
#pragma once

#include "engine/base/result.h"
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
  void draw(const FrameView& view, const SurfaceBuffers& surface, const SurfaceLook& look,
            const ToolSphere& tool, const ShadowPass* shadow) const;

 private:
  SurfacePass(const GlFunctions& gl, Program opaque, Program translucent)
      : gl_(&gl), opaque_(std::move(opaque)), translucent_(std::move(translucent)) {}
  void set_uniforms(const Program& program, const FrameView& view, const SurfaceLook& look,
                    const ToolSphere& tool, const ShadowPass* shadow) const;

  const GlFunctions* gl_;
  // Two, because a software renderer computes both sides of every branch.
  Program opaque_, translucent_;
};

}  // namespace spoonbill
