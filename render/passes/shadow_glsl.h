// The shaders of ShadowPass.
#pragma once

namespace spoonbill {

extern const char* const shadow_depth_vertex_glsl;
extern const char* const shadow_depth_fragment_glsl;

// The depth maps at a quarter of their resolution: red the share covered from the key light, green that share
// times the mean height of what covers, blue the closeness of what hangs overhead.
extern const char* const shadow_reduce_fragment_glsl;

// The light on the ground: percentage-closer soft shadow of the key light, and the sky hidden close by. Needs
// the sphere functions before it.
extern const char* const ground_light_fragment_glsl;

}  // namespace spoonbill
