#include <algorithm>
#include <string>
#include <utility>

#include "render/passes/material_patterns.h"
#include "render/passes/studio_light.h"
#include "render/passes/surface_passes.h"

namespace spoonbill {
namespace {

// Distance by which a translucent surface is moved toward the eye for the depth test. Bodies that rest on
// each other may overlap by 0.05 mm, which is more along a grazing line of sight, and would show through each
// other in patches.
constexpr float translucent_lift_m = 3e-4f;

constexpr const char* body_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform float lift;
layout(location = 0) in float x;
layout(location = 1) in float y;
layout(location = 2) in float z;
layout(location = 3) in float nx;
layout(location = 4) in float ny;
layout(location = 5) in float nz;
layout(location = 6) in float visibility;
layout(location = 7) in float back_visibility;
layout(location = 8) in float tint;
out vec3 position;
out vec3 normal;
out vec2 visible;
out float fixed_part;
void main() {
  visible = vec2(visibility, back_visibility);
  fixed_part = tint;
  position = vec3(x, y, z);
  normal = vec3(nx, ny, nz);
  gl_Position = world_to_clip * vec4(position, 1.0);
  if (lift > 0.0) {
    vec4 lifted = world_to_clip * vec4(position + normalize(eye - position) * lift, 1.0);
    gl_Position.z = lifted.z / lifted.w * gl_Position.w;
  }
}
)";

// Fragment shader of a body. The constant `clear` must be prepended to the source. Five bilinear comparisons
// blur the edge of the shadow over about a millimetre; the offset along the normal prevents self-shadowing.
constexpr const char* body_fragment_source = R"(
uniform sampler2DShadow key_map;
uniform mat4 key_to_clip;
uniform float texel;
uniform float texel_m;
uniform int shadowed;
uniform int two_sided;
uniform vec4 fixed_tint;
uniform vec3 base_colour;
uniform float roughness;
uniform float metalness;
uniform float translucency;
in vec3 position;
in vec3 normal;
in vec2 visible;
in float fixed_part;
out vec4 result;

float key_past_body(vec3 n) {
  vec3 at = (key_to_clip * vec4(position + n * (4.0 * texel_m), 1.0)).xyz * 0.5 + 0.5;
  float lit = texture(key_map, at);
  for (int i = 0; i < 4; ++i) {
    vec2 offset = vec2(float(i & 1) - 0.5, float(i >> 1) - 0.5) * 3.6 * texel;
    lit += texture(key_map, vec3(at.xy + offset, at.z));
  }
  return lit / 5.0;
}

void main() {
  vec3 n = normalize(normal);
  bool is_back = two_sided != 0 && !gl_FrontFacing;
  if (is_back) n = -n;
  Skin skin = patterned(Skin(base_colour, n, is_back ? visible.y : visible.x), position);
  float key = 1.0;
  float sky = skin.visible;
  if (shadowed != 0) {
    key = key_past_sphere(position);
    sky *= sky_past_sphere(position, n);
    if (dot(n, toward_key) > 0.0) key *= mix(key_past_body(n), 1.0, 0.6 * translucency);
  }
  float tinted = fixed_tint.a * fixed_part;
  vec3 base = mix(skin.base, fixed_tint.rgb, tinted);
  Look look = Look(base, roughness, metalness * (1.0 - tinted), translucency);
  Lit lit = studio_light(look, position, skin.normal, key, sky);
  float grazing = 1.0 - clamp(abs(dot(n, normalize(eye - position))), 0.0, 1.0);
  float opacity = mix(1.0, 0.16 + 0.7 * grazing * grazing, translucency);
  result = clear ? clear_colour(lit, opacity) : opaque_colour(lit);
}
)";

std::string body_fragment_shader(const SurfaceVariant& variant) {
  const auto constant = [](const char* name, bool value) {
    return std::string("const bool ") + name + (value ? " = true;\n" : " = false;\n");
  };
  return constant("clear", variant.is_clear) + constant("reflects", variant.reflects) + key_light_glsl +
         sphere_shadow_glsl + studio_light_glsl + pattern_glsl(variant.pattern) + body_fragment_source;
}

}  // namespace

Status SurfacePass::prepare(const SurfaceVariant& variant) {
  if (programs_.contains(variant)) return {};
  auto program = Program::make(*gl_, "surface", body_vertex_source, body_fragment_shader(variant));
  if (!program) return program.error();
  programs_.emplace(variant, std::move(program).value());
  return {};
}

void SurfacePass::set_uniforms(const Program& program, const FrameView& view, const SurfaceDrawing& drawing,
                               const ToolSphere& tool, const ShadowPass* shadow) const {
  const SurfaceLook& look = drawing.look;
  program.use();
  set_frame_uniforms(program, view);
  set_studio_uniforms(program, view);
  set_tool_uniforms(program, tool);
  program.set("world_to_pattern", drawing.world_to_pattern);
  constexpr Colour fixed = palette::fixed_part;
  const float opacity = drawing.shows_fixed ? static_cast<float>(fixed.a) / 255.0f : 0.0f;
  program.set("fixed_tint", Eigen::Vector4f(srgb8_to_linear(fixed.r), srgb8_to_linear(fixed.g),
                                            srgb8_to_linear(fixed.b), opacity));
  program.set("base_colour", look.base_colour);
  program.set("roughness", look.roughness);
  program.set("metalness", look.metalness);
  program.set("translucency", look.translucency);
  program.set("lift", look.is_clear() ? std::min(translucent_lift_m, lift_limit_m(view)) : 0.0f);
  program.set("key_map", 0);
  program.set("shadowed", shadow != nullptr ? 1 : 0);
  if (shadow == nullptr) return;
  const auto side_px = static_cast<float>(ShadowPass::key_map_side_px());
  program.set("key_to_clip", shadow->area().key_to_clip);
  program.set("texel", 1.0f / side_px);
  program.set("texel_m", shadow->area().side_m / side_px);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, shadow->key_map());
}

void SurfacePass::draw(const FrameView& view, const SurfaceBuffers& surface, const SurfaceDrawing& drawing,
                       const ToolSphere& tool, const ShadowPass* shadow) const {
  const Program& program = programs_.at(drawing.variant());
  set_uniforms(program, view, drawing, tool, shadow);
  if (drawing.look.is_clear()) {
    program.set("two_sided", 1);
    for (const Cull cull : {Cull::front, Cull::back}) {
      set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, cull});
      surface.draw();
    }
    return;
  }
  const bool closed = surface.is_closed();
  program.set("two_sided", closed ? 0 : 1);
  set_pipeline_state(*gl_, {Depth::test_and_write, Blend::off, closed ? Cull::back : Cull::off});
  surface.draw();
}

}  // namespace spoonbill
