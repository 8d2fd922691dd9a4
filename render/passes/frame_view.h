// What all passes of a frame share. Made once a frame, read by every pass; world space in metres.
#pragma once

#include <Eigen/Core>

#include "render/camera.h"
#include "render/gl/program.h"
#include "render/view_settings.h"

namespace spoonbill {

struct FrameView {
  Viewport viewport;
  Eigen::Matrix4f world_to_clip;
  Eigen::Vector3f eye_m;
  Eigen::Vector3f eye_right, eye_up;  // unit
  Eigen::Vector3f toward_key;         // unit, at least 12 degrees above the horizon
  float ground_y_m = 0.0f;
  float interface_scale = 1.0f;
  float nearest_depth_m = 0.0f;    // lines are cut here before they are widened
  float pixel_depth_ratio = 0.0f;  // pixels that a length of one metre covers at a depth of one metre
};

FrameView make_frame_view(const ViewSettings& settings, int width_px, int height_px);

// Sets the uniforms that every scene shader may use: world_to_clip, eye, toward_key, ground_y, and the ways
// of the lights that turn with the eye: toward_fill, toward_rim, toward_strip.
void set_frame_uniforms(const Program& program, const FrameView& view);

}  // namespace spoonbill
