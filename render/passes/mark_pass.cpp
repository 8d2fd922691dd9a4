#include "render/passes/mark_pass.h"

#include <cstddef>
#include <utility>

#include "render/gl/pipeline_state.h"

namespace spoonbill {
namespace {

constexpr const char* vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform vec2 viewport;
uniform float lift;
uniform float scale;
uniform float pixel_depth_ratio;
layout(location = 0) in vec3 centre;
layout(location = 1) in vec4 srgb;
layout(location = 2) in float radius;
layout(location = 3) in float least_px;
layout(location = 4) in float shape_in;
noperspective out vec2 offset_px;
flat out float radius_px;
flat out vec4 colour;
flat out int shape;

void main() {
  float px_per_m = pixel_depth_ratio / max((world_to_clip * vec4(centre, 1.0)).w, 1e-6);
  radius_px = clamp(radius * px_per_m, least_px * scale, 7.0 * scale);
  // Far enough toward the eye that a slanting surface does not cut the near half off.
  float raised = max(lift, 2.5 * radius_px / px_per_m);
  vec4 clip = world_to_clip * vec4(centre + normalize(eye - centre) * raised, 1.0);
  colour = srgb;
  shape = int(shape_in + 0.5);
  vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4 ? 1.0 : -1.0,
                     gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5 ? 1.0 : -1.0);
  offset_px = corner * (radius_px * (shape == 2 ? 1.5 : 1.0) + 1.25);
  clip.xy += offset_px * 2.0 / viewport * clip.w;
  gl_Position = clip;
}
)";

constexpr const char* fragment_source = R"(
noperspective in vec2 offset_px;
flat in float radius_px;
flat in vec4 colour;
flat in int shape;
out vec4 result;

float distance_to_edge() {
  vec2 q = abs(offset_px);
  if (shape == 0) return max(q.x, q.y) - 0.9 * radius_px;
  if (shape == 1) return length(q) - radius_px;
  return (q.x + q.y - 1.4 * radius_px) * 0.7071;
}

void main() {
  float edge = distance_to_edge();
  float alpha = colour.a * clamp(0.5 - edge, 0.0, 1.0);
  float inside = clamp(-edge - 0.4, 0.0, 1.0);
  vec3 shade = mix(0.6 * colour.rgb, colour.rgb, inside);
  result = vec4(shade * alpha, alpha);
}
)";

}  // namespace

Result<MarkPass> MarkPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "marks", vertex_source, fragment_source);
  if (!program) return program.error();
  return MarkPass(gl, std::move(program).value());
}

MarkPass::MarkPass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      quads_(gl, sizeof(OverlayMark),
             {{3, GL_FLOAT, offsetof(OverlayMark, position_m)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayMark, colour)},
              {1, GL_FLOAT, offsetof(OverlayMark, radius_m)},
              {1, GL_FLOAT, offsetof(OverlayMark, least_px)},
              {1, GL_FLOAT, offsetof(OverlayMark, shape)}}) {}

void MarkPass::draw(const FrameView& view, const std::vector<OverlayMark>& marks, float lift_m) const {
  if (marks.empty()) return;
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("viewport", Eigen::Vector2f(static_cast<float>(view.viewport.width_px),
                                           static_cast<float>(view.viewport.height_px)));
  program_.set("lift", lift_m);
  program_.set("scale", view.interface_scale);
  program_.set("pixel_depth_ratio", view.pixel_depth_ratio);
  quads_.draw(marks);
}

}  // namespace spoonbill
