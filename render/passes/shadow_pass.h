// The shadows of the bodies: the depth map for shadows on the bodies, and the light that reaches the ground.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "render/gl/pipeline.h"
#include "render/passes/frame_view.h"
#include "render/passes/mesh_buffers.h"

namespace spoonbill {

// The part of the ground that shadows can reach, and the projections of the world onto it.
//
// The shadow map covers the ground, not a plane perpendicular to the light. A point is projected along the
// light onto the ground, and its depth in the map depends only on its height above the ground. One map
// therefore serves both the shadow of a body on itself and the shadow on the ground.
struct ShadowArea {
  Eigen::Vector2f corner_m;       // smallest x and z
  float side_m = 0.0f;            // side of the square that the map covers
  Eigen::Vector2f used_fraction;  // fraction of the square, from the corner, that shadows can reach
  // Range of heights above the ground that the depth of the map represents. high_m is the upper end.
  float low_m = 0.0f, high_m = 0.0f;
  Eigen::Matrix4f key_to_clip;  // from the world to the clip space of the key light's shadow map
  Eigen::Matrix4f sky_to_clip;  // maps the world to the map of occluders above the ground, seen from below
};

// Tangent of half the angle that the key light subtends: the rate at which shadows soften with distance.
inline constexpr float key_light_spread = 0.17f;

// Computes the shadow area. The corner moves in steps of whole texels, and the side has eight sizes per
// octave, so that edges do not crawl while the scene moves slightly. The area includes the ground around the
// tool, although the tool is not drawn into the map. Either box may be empty. toward_key points above the
// horizon.
ShadowArea shadow_area(const Box& body, const Box& tool, float ground_y_m, const Eigen::Vector3f& toward_key,
                       int map_side_px);

// The sphere that represents the tool in the shaders.
struct ToolSphere {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0f;  // 0 without a tool
};

// Sets the uniforms tool_centre and tool_radius.
void set_tool_uniforms(const Program& program, const ToolSphere& tool);

class ShadowPass {
 public:
  static Result<ShadowPass> make(const GlFunctions& gl);

  // Draws the maps. Changes the bound framebuffer, the viewport and the pipeline state.
  void draw(const FrameView& view, const std::vector<SurfaceBuffers>& bodies, const Box& body_box,
            const Box& tool_box, const ToolSphere& tool);

  // Results of the last draw().
  const ShadowArea& area() const { return area_; }
  GLuint key_map() const { return key_map_.id(); }  // depth texture with comparison and bilinear filter
  GLuint ground_dark() const { return ground_dark_.id(); }  // red: darkening of the ground, 0 in the open

  static int key_map_side_px();

 private:
  struct Programs {
    Program depth, cover, ground;
  };
  ShadowPass(const GlFunctions& gl, Programs programs);
  void draw_key_map(const std::vector<SurfaceBuffers>& bodies) const;
  void draw_cover(const FrameView& view, const std::vector<SurfaceBuffers>& bodies) const;
  float highest_m() const;  // greatest height of the bodies above the ground, at least 0.1 mm
  void light_ground(const FrameView& view, const ToolSphere& tool) const;

  const GlFunctions* gl_;
  Programs programs_;
  ShadowArea area_;
  GlHandle vertex_array_;
  GlHandle key_map_, cover_, ground_dark_;
  GlHandle key_framebuffer_, cover_framebuffer_, ground_framebuffer_;
};

}  // namespace spoonbill
