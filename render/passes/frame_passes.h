// Passes over the whole frame: background, shadows on the ground, and the resolved scene.
#pragma once

#include <span>

#include "engine/base/result.h"
#include "render/gl/pipeline.h"
#include "render/gl/render_target.h"
#include "render/passes/frame_view.h"
#include "render/passes/shadow_pass.h"

namespace spoonbill {

// Draws the vertical gradient behind the scene. The gradient is made again when the frame size or the studio
// changes, and copied to every frame, which takes a tenth of the time that drawing it would take.
class BackgroundPass {
 public:
  explicit BackgroundPass(const GlFunctions& gl) : gl_(&gl) {}

  // Writes every pixel of the target's frame layer and leaves this layer bound.
  void draw(const Studio& studio, const RenderTarget& target);

 private:
  void build(const Studio& studio, const RenderTarget& target);

  const GlFunctions* gl_;
  GlHandle picture_;
  GlHandle framebuffer_;
  int width_px_ = 0, height_px_ = 0;
  GLenum channels_ = 0;
  Eigen::Vector3f top_srgb_, bottom_srgb_;
};

// Draws the shadows on the ground. The ground itself is not drawn, so that it has no edge: the background
// stays visible.
class GroundPass {
 public:
  static Result<GroundPass> make(const GlFunctions& gl);

  // Darkens the ground where it is in shadow. Must follow the background. Draws nothing if the eye is below
  // the ground.
  void draw_shadow(const FrameView& view, const ShadowPass& shadow) const;

 private:
  GroundPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
};

// Averages the samples of the scene, or stretches a scene with fewer pixels, and blends the result over the
// frame.
class ResolvePass {
 public:
  static Result<ResolvePass> make(const GlFunctions& gl);

  // Resolves the areas in which the scene was drawn. The target's frame must be bound.
  void draw(const RenderTarget& target, std::span<const PixelArea> areas) const;

 private:
  ResolvePass(const GlFunctions& gl, Program with_samples, Program without_samples, Program stretched);

  const GlFunctions* gl_;
  Program with_samples_, without_samples_, stretched_;
  GlHandle vertex_array_;
};

}  // namespace spoonbill
