// The shaders of ShadowPass.
#pragma once

namespace spoonbill {

extern const char* const shadow_depth_vertex_glsl;
extern const char* const shadow_depth_fragment_glsl;

// What covers the ground, by MAX blending: red where the key light is covered, green how high by the highest
// that covers there, blue how close the lowest hangs overhead.
extern const char* const shadow_cover_vertex_glsl;
extern const char* const shadow_cover_fragment_glsl;

// The light on the ground: percentage-closer soft shadow of the key light, and the sky hidden close by. Needs
// the sphere functions before it.
extern const char* const ground_light_fragment_glsl;

}  // namespace spoonbill
