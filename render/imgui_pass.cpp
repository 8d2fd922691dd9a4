#include "render/imgui_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace spoonbill {

namespace {

constexpr const char* vertex_source = R"(
uniform mat4 to_clip;
layout(location = 0) in vec2 position_px;
layout(location = 1) in vec2 atlas_position;
layout(location = 2) in vec4 colour;
out vec2 texel;
out vec4 tint;
void main() {
  texel = atlas_position;
  tint = colour;
  gl_Position = to_clip * vec4(position_px, 0.0, 1.0);
}
)";

constexpr const char* fragment_source = R"(
uniform sampler2D atlas;
in vec2 texel;
in vec4 tint;
out vec4 result;
void main() { result = tint * texture(atlas, texel); }
)";

Eigen::Matrix4f display_to_clip(const ImDrawData& data) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix(0, 0) = 2.0f / data.DisplaySize.x;
  matrix(1, 1) = -2.0f / data.DisplaySize.y;
  matrix(0, 3) = -1.0f - data.DisplayPos.x * matrix(0, 0);
  matrix(1, 3) = 1.0f - data.DisplayPos.y * matrix(1, 1);
  return matrix;
}

// Conversions between ImGui texture handles, which are opaque pointers, and GL names.
ImTextureID texture_handle(GLuint texture) {
  return reinterpret_cast<ImTextureID>(std::uintptr_t{texture});
}
GLuint texture_name(ImTextureID handle) {
  return static_cast<GLuint>(reinterpret_cast<std::uintptr_t>(handle));
}

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

}  // namespace

Result<ImGuiPass> ImGuiPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "interface", vertex_source, fragment_source);
  if (!program) return program.error();
  return ImGuiPass(gl, std::move(program).value());
}

ImGuiPass::ImGuiPass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)),
      indices_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  for (GLuint attribute = 0; attribute < 3; ++attribute) gl.EnableVertexAttribArray(attribute);
  constexpr GLsizei stride = sizeof(ImDrawVert);
  gl.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, pos)));
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ImDrawVert, uv)));
  gl.VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(ImDrawVert, col)));
}

void ImGuiPass::upload_fonts(ImFontAtlas& atlas) {
  unsigned char* coverage = nullptr;
  int width = 0, height = 0;
  atlas.GetTexDataAsAlpha8(&coverage, &width, &height);
  atlas_ = make_texture(*gl_);
  gl_->BindTexture(GL_TEXTURE_2D, atlas_.id());
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, width, height, 0, GL_RED, GL_UNSIGNED_BYTE, coverage);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  constexpr GLint white_with_coverage[4] = {GL_ONE, GL_ONE, GL_ONE, GL_RED};
  gl_->TexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, white_with_coverage);
  atlas.SetTexID(texture_handle(atlas_.id()));
}

void ImGuiPass::set_state(const ImDrawData& data) const {
  set_pipeline_state(*gl_, {});
  gl_->Enable(GL_BLEND);
  gl_->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->Enable(GL_SCISSOR_TEST);
  gl_->Viewport(0, 0, static_cast<GLsizei>(data.DisplaySize.x * data.FramebufferScale.x),
                static_cast<GLsizei>(data.DisplaySize.y * data.FramebufferScale.y));
  program_.use();
  program_.set("to_clip", display_to_clip(data));
  program_.set("atlas", 0);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
}

void ImGuiPass::draw(const ImDrawData& data) const {
  if (data.DisplaySize.x <= 0.0f || data.DisplaySize.y <= 0.0f) return;
  set_state(data);
  for (int i = 0; i < data.CmdListsCount; ++i) draw_list(data, *data.CmdLists[i]);
  gl_->Disable(GL_SCISSOR_TEST);
}

void ImGuiPass::draw_list(const ImDrawData& data, const ImDrawList& list) const {
  gl_->BufferData(GL_ARRAY_BUFFER, list.VtxBuffer.Size * static_cast<GLsizeiptr>(sizeof(ImDrawVert)),
                  list.VtxBuffer.Data, GL_STREAM_DRAW);
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.Size * static_cast<GLsizeiptr>(sizeof(ImDrawIdx)),
                  list.IdxBuffer.Data, GL_STREAM_DRAW);
  const float height = data.DisplaySize.y * data.FramebufferScale.y;
  for (const ImDrawCmd& command : list.CmdBuffer) {
    if (command.UserCallback != nullptr) {
      if (command.UserCallback == ImDrawCallback_ResetRenderState) {
        set_state(data);
      } else {
        command.UserCallback(&list, &command);
      }
      continue;
    }
    const float x0 = (command.ClipRect.x - data.DisplayPos.x) * data.FramebufferScale.x;
    const float y0 = (command.ClipRect.y - data.DisplayPos.y) * data.FramebufferScale.y;
    const float x1 = (command.ClipRect.z - data.DisplayPos.x) * data.FramebufferScale.x;
    const float y1 = (command.ClipRect.w - data.DisplayPos.y) * data.FramebufferScale.y;
    if (x1 <= x0 || y1 <= y0) continue;
    gl_->Scissor(static_cast<GLint>(x0), static_cast<GLint>(height - y1), static_cast<GLsizei>(x1 - x0),
                 static_cast<GLsizei>(y1 - y0));
    gl_->BindTexture(GL_TEXTURE_2D, texture_name(command.GetTexID()));
    constexpr GLenum index_type = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    gl_->DrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount), index_type,
                                offset(command.IdxOffset * sizeof(ImDrawIdx)),
                                static_cast<GLint>(command.VtxOffset));
  }
}

}  // namespace spoonbill
