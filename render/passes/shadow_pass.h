// What the body hides of the key light and of the sky: the depth map that the body reads for its own shadow,
// and the light that reaches the ground, ready to be laid over it.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"
#include "render/passes/frame_view.h"
#include "render/passes/shadow_area.h"
#include "render/passes/surface_buffers.h"

namespace spoonbill {

// The round tool as the shaders know it.
struct ToolSphere {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0f;  // 0 without a tool
};

// Sets tool_centre and tool_radius.
void set_tool_uniforms(const Program& program, const ToolSphere& tool);

class ShadowPass {
 public:
  static Result<ShadowPass> make(const GlFunctions& gl);

  // Draws the maps. The bound framebuffer, viewport and state are changed.
  void draw(const FrameView& view, const std::vector<SurfaceBuffers>& bodies, const Box& body_box,
            const Box& tool_box, const ToolSphere& tool);

  // Of the last draw().
  const ShadowArea& area() const { return area_; }
  GLuint key_map() const { return key_map_.id(); }  // depth with comparison, bilinear
  GLuint ground_dark() const {
    return ground_dark_.id();
  }  // red: how far to dim what is behind; 0 in the open

  static int key_map_side_px();

 private:
  struct Programs {
    Program depth, cover, ground;
  };
  ShadowPass(const GlFunctions& gl, Programs programs);
  void draw_key_map(const std::vector<SurfaceBuffers>& bodies) const;
  void draw_cover(const FrameView& view, const std::vector<SurfaceBuffers>& bodies) const;
  float highest_m() const;  // above the ground, more than 0
  void light_ground(const FrameView& view, const ToolSphere& tool) const;

  const GlFunctions* gl_;
  Programs programs_;
  ShadowArea area_;
  GlHandle vertex_array_;
  GlHandle key_map_, cover_, ground_dark_;
  GlHandle key_framebuffer_, cover_framebuffer_, ground_framebuffer_;
};

}  // namespace spoonbill
