// GLSL that several scene shaders share: the studio's lights, materials, and the tool's soft shadow. Linear
// light.
#pragma once

namespace spoonbill {

// The uniform toward_key, which both parts below need before them.
extern const char* const key_light_glsl;

// Functions of the round tool: how much of the key light and of the sky it hides. Uniforms: tool_centre,
// tool_radius (0 without a tool).
extern const char* const sphere_shadow_glsl;

// studio_light(): the light that a surface point sends to the eye; opaque_colour() and clear_colour() encode
// it to sRGB.
// Uniforms: eye, eye_right, eye_up, ground_y.
extern const char* const studio_light_glsl;

}  // namespace spoonbill
