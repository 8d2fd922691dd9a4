#include "render/passes/ground_pass.h"

#include <utility>

#include "render/gl/pipeline_state.h"

namespace spoonbill {
namespace {

constexpr const char* vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec2 corner;
uniform vec2 size;
uniform vec2 used;
uniform float ground_y;
out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * used;
  vec2 at = corner + uv * size;
  gl_Position = world_to_clip * vec4(at.x, ground_y, at.y, 1.0);
}
)";

constexpr const char* fragment_source = R"(
uniform sampler2D ground_dark;
in vec2 uv;
out vec4 result;
void main() {
  float dark = texture(ground_dark, uv).r;
  result = vec4(vec3(0.10, 0.11, 0.14) * dark, dark);
}
)";

}  // namespace

Result<GroundPass> GroundPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "ground", vertex_source, fragment_source);
  if (!program) return program.error();
  return GroundPass(gl, std::move(program).value());
}

GroundPass::GroundPass(const GlFunctions& gl, Program program)
    : gl_(&gl), program_(std::move(program)), vertex_array_(make_vertex_array(gl)) {}

void GroundPass::draw_shadow(const FrameView& view, const ShadowPass& shadow) const {
  if (view.eye_m.y() <= view.ground_y_m) return;
  const ShadowArea& area = shadow.area();
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("corner", area.corner_m);
  program_.set("size", Eigen::Vector2f(area.side_m, area.side_m));
  program_.set("used", area.used_share);
  program_.set("ground_dark", 0);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, shadow.ground_dark());
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace spoonbill
