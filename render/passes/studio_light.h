// GLSL for the lights and the surroundings of the studio, and its uniforms. World space in metres, linear
// light.
#pragma once

#include "render/gl/pipeline.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

// Sets the uniforms of the studio: the directions of the lights that move with the eye, toward_fill,
// toward_rim and toward_strip, the colours of all lights, and the brightness of the surroundings.
void set_studio_uniforms(const Program& program, const FrameView& view);

// Functions for the lights and materials of the studio. studio_light() returns the light from a surface point
// to the eye; opaque_colour() and clear_colour() encode it to sRGB. A constant bool `reflects`, which tells
// whether surfaces mirror the studio, and key_light_glsl must precede it. Uniforms: eye, ground_y, and those
// of set_studio_uniforms().
extern const char* const studio_light_glsl;

}  // namespace spoonbill
