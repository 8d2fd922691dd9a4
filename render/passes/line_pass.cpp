#include "render/passes/line_pass.h"

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
uniform float width_scale;
uniform float nearest_depth;
layout(location = 0) in vec3 start;
layout(location = 1) in vec3 end;
layout(location = 2) in vec4 start_colour;
layout(location = 3) in vec4 end_colour;
layout(location = 4) in float width;
noperspective out float side_px;
noperspective out vec4 colour;
flat out float half_width;

vec4 lifted(vec3 p) { return world_to_clip * vec4(p + normalize(eye - p) * lift, 1.0); }

void main() {
  vec4 a = lifted(start);
  vec4 b = lifted(end);
  half_width = 0.5 * width * width_scale;
  side_px = 0.0;
  colour = vec4(0.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (max(a.w, b.w) < nearest_depth) return;
  if (a.w < nearest_depth) a = mix(a, b, (nearest_depth - a.w) / (b.w - a.w));
  if (b.w < nearest_depth) b = mix(b, a, (nearest_depth - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
  float length_px = length(along);
  along = length_px > 1e-4 ? along / length_px : vec2(1.0, 0.0);
  bool at_end = gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4;
  float side = gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5 ? 1.0 : -1.0;
  // Wide enough that every pixel with some of the line is covered whole: the smooth edge is the only one.
  side_px = side * (half_width + 1.25);
  colour = at_end ? end_colour : start_colour;
  vec4 clip = at_end ? b : a;
  clip.xy += vec2(-along.y, along.x) * side_px * 2.0 / viewport * clip.w;
  gl_Position = clip;
}
)";

constexpr const char* fragment_source = R"(
noperspective in float side_px;
noperspective in vec4 colour;
flat in float half_width;
out vec4 result;
void main() {
  float alpha = colour.a * clamp(half_width + 0.5 - abs(side_px), 0.0, 1.0);
  result = vec4(colour.rgb * alpha, alpha);
}
)";

}  // namespace

Result<LinePass> LinePass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "lines", vertex_source, fragment_source);
  if (!program) return program.error();
  return LinePass(gl, std::move(program).value());
}

LinePass::LinePass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      quads_(gl, sizeof(OverlayLine),
             {{3, GL_FLOAT, offsetof(OverlayLine, start_m)},
              {3, GL_FLOAT, offsetof(OverlayLine, end_m)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayLine, start_colour)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayLine, end_colour)},
              {1, GL_FLOAT, offsetof(OverlayLine, width_px)}}) {}

void LinePass::draw(const FrameView& view, const std::vector<OverlayLine>& lines, float lift_m) const {
  if (lines.empty()) return;
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("viewport", Eigen::Vector2f(static_cast<float>(view.viewport.width_px),
                                           static_cast<float>(view.viewport.height_px)));
  program_.set("lift", lift_m);
  program_.set("width_scale", view.interface_scale);
  program_.set("nearest_depth", view.nearest_depth_m);
  quads_.draw(lines);
}

}  // namespace spoonbill
