// The part of the ground that shadows can fall on, and the projections of the world onto it. No GL.
//
// The shadow map is laid out over the ground, not across the light: a point is carried along the light's
// direction down to the ground, and its depth is its height. So one map serves the body's shadow on itself
// and, read where it lies, the shadow on the ground.
#pragma once

#include <Eigen/Core>

#include "render/camera.h"

namespace spoonbill {

struct ShadowArea {
  Eigen::Vector2f corner_m;           // smallest x and z
  float side_m = 0.0f;                // of the square that the map covers
  Eigen::Vector2f used_share;         // the part of the square, from the corner, that shadows can reach
  float low_m = 0.0f, high_m = 0.0f;  // heights that the map's depth spans, above the ground
  Eigen::Matrix4f key_to_clip;        // world to the key light's map
  Eigen::Matrix4f sky_to_clip;        // world to the map of what hangs over the ground, seen from below
};

// The tangent of half the angle that the key light fills: how fast shadows soften with distance.
inline constexpr float key_light_spread = 0.17f;

// Corner and side move in steps of the map's texels and of eighths of the size, so that edges do not crawl
// while the scene moves a little. The tool needs room on the ground but is not in the map. Either box may be
// empty. toward_key points above the horizon.
ShadowArea shadow_area(const Box& body, const Box& tool, float ground_y_m, const Eigen::Vector3f& toward_key,
                       int map_side_px);

}  // namespace spoonbill
