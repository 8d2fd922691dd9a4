// Data that all passes share: the view of one frame, and GLSL for shadows. World space in metres,
// linear light.
#pragma once

#include <Eigen/Core>

#include "render/camera.h"
#include "render/gl/pipeline.h"
#include "render/studio.h"
#include "render/view_settings.h"

namespace spoonbill {

// The view of one frame, made once and read by every pass.
struct FrameView {
  Viewport viewport;
  Eigen::Matrix4f world_to_clip;
  Eigen::Vector3f eye_m;
  Eigen::Vector3f eye_right, eye_up;  // unit vectors
  Eigen::Vector3f toward_key;         // unit vector, at least 11 degrees above the horizon
  Studio studio;
  float studio_turn_rad = 0.0f;  // angle by which the lights that move with the eye are turned
  float ground_y_m = 0.0f;
  float interface_scale = 1.0f;
  float nearest_depth_m = 0.0f;    // depth at which lines are clipped before they are widened
  float pixel_depth_ratio = 0.0f;  // length in pixels of one metre at a depth of one metre
};

// Returns the largest distance by which things may be lifted toward the eye, so that they stay before it
// however near it is.
inline float lift_limit_m(const FrameView& view) {
  return 0.1f * view.nearest_depth_m;
}

FrameView make_frame_view(const ViewSettings& settings, int width_px, int height_px);

// Sets the uniforms that every scene shader may use: world_to_clip, eye, toward_key, ground_y.
void set_frame_uniforms(const Program& program, const FrameView& view);

// A vertex shader for passes over a whole viewport: draws one triangle that covers it from three vertices
// without attributes.
extern const char* const whole_viewport_vertex_glsl;

// The declaration of the uniform toward_key. It must precede sphere_shadow_glsl and studio_light_glsl.
extern const char* const key_light_glsl;

// Functions for the shadow of the tool, which is a sphere here: the fractions of key light and sky light that
// reach a point past the sphere. The edge of the shadow softens with the distance to the sphere. The
// occlusion of the sky approximates the exact formula for a sphere above a plane. Uniforms: tool_centre,
// tool_radius (0 without a tool).
extern const char* const sphere_shadow_glsl;

}  // namespace spoonbill
