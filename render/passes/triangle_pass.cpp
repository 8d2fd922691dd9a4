#include "render/passes/triangle_pass.h"

#include <cstddef>
#include <utility>

#include "render/gl/pipeline_state.h"

namespace spoonbill {
namespace {

constexpr const char* vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform float lift;
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 srgb;
flat out vec4 colour;
void main() {
  colour = srgb;
  gl_Position = world_to_clip * vec4(corner + normalize(eye - corner) * lift, 1.0);
}
)";

constexpr const char* fragment_source = R"(
flat in vec4 colour;
out vec4 result;
void main() { result = vec4(colour.rgb * colour.a, colour.a); }
)";

}  // namespace

Result<TrianglePass> TrianglePass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "triangles", vertex_source, fragment_source);
  if (!program) return program.error();
  return TrianglePass(gl, std::move(program).value());
}

TrianglePass::TrianglePass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  constexpr GLsizei stride = sizeof(OverlayCorner);
  const auto at = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, at(offsetof(OverlayCorner, position_m)));
  gl.VertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, at(offsetof(OverlayCorner, colour)));
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
}

void TrianglePass::draw(const FrameView& view, const std::vector<OverlayCorner>& corners,
                        float lift_m) const {
  if (corners.empty()) return;
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("lift", lift_m);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(OverlayCorner)),
                  corners.data(), GL_STREAM_DRAW);
  gl_->DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
}

}  // namespace spoonbill
