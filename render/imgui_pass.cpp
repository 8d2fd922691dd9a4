#include "render/imgui_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
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

// A rectangle of the framebuffer, with the origin of GL.
struct PixelRectangle {
  int left = 0, bottom = 0, right = 0, top = 0;

  PixelRectangle intersection(const PixelRectangle& other) const {
    return {std::max(left, other.left), std::max(bottom, other.bottom), std::min(right, other.right),
            std::min(top, other.top)};
  }
  bool empty() const { return left >= right || bottom >= top; }
};

// Converts rectangles of the display to the framebuffer.
struct DisplayArea {
  ImVec2 origin, scale;
  float height_px;

  explicit DisplayArea(const ImDrawData& data)
      : origin(data.DisplayPos),
        scale(data.FramebufferScale),
        height_px(data.DisplaySize.y * data.FramebufferScale.y) {}

  ImVec2 pixel(const ImVec2& at) const {
    return {(at.x - origin.x) * scale.x, height_px - (at.y - origin.y) * scale.y};
  }
  PixelRectangle rectangle(const ImVec2& low, const ImVec2& high) const {
    const ImVec2 a = pixel(low), b = pixel(high);
    return {static_cast<int>(a.x), static_cast<int>(b.y), static_cast<int>(b.x), static_cast<int>(a.y)};
  }
};

bool is_whole(const ImVec2& pixel) {
  return pixel.x == std::floor(pixel.x) && pixel.y == std::floor(pixel.y);
}

constexpr float fewest_cleared_px = 1000.0f;  // in a smaller rectangle, clearing takes as long as drawing

// Returns the pixels that two triangles fill with one opaque colour: those of a rectangle that ImGui has
// drawn without a texture, if it is large and aligned with the pixels. `corners` are the six indices of the
// triangles.
std::optional<PixelRectangle> find_solid(const ImDrawVert* vertices, const ImDrawIdx* corners,
                                         const ImVec2& white, const DisplayArea& area) {
  if (corners[3] != corners[0] || corners[4] != corners[2]) return std::nullopt;
  const ImDrawVert& a = vertices[corners[0]];
  const ImDrawVert& c = vertices[corners[2]];
  const bool has_corners = vertices[corners[1]].pos.x == c.pos.x && vertices[corners[1]].pos.y == a.pos.y &&
                           vertices[corners[5]].pos.x == a.pos.x && vertices[corners[5]].pos.y == c.pos.y;
  if (!has_corners || (a.col >> IM_COL32_A_SHIFT) != 255) return std::nullopt;
  for (const int corner : {0, 1, 2, 5}) {
    const ImDrawVert& vertex = vertices[corners[corner]];
    if (vertex.col != a.col || vertex.uv.x != white.x || vertex.uv.y != white.y) return std::nullopt;
  }
  const ImVec2 first = area.pixel(a.pos), last = area.pixel(c.pos);
  const bool is_large = (last.x - first.x) * (first.y - last.y) >= fewest_cleared_px;
  if (!is_large || !is_whole(first) || !is_whole(last)) return std::nullopt;
  return area.rectangle(a.pos, c.pos);
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
  white_ = atlas.TexUvWhitePixel;
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
  for (const ImDrawCmd& command : list.CmdBuffer) {
    if (command.UserCallback == nullptr) {
      draw_command(data, list, command);
    } else if (command.UserCallback == ImDrawCallback_ResetRenderState) {
      set_state(data);
    } else {
      command.UserCallback(&list, &command);
    }
  }
}

void ImGuiPass::draw_command(const ImDrawData& data, const ImDrawList& list, const ImDrawCmd& command) const {
  const DisplayArea area(data);
  const PixelRectangle clip =
      area.rectangle({command.ClipRect.x, command.ClipRect.y}, {command.ClipRect.z, command.ClipRect.w});
  if (clip.empty()) return;
  const auto set_scissor = [&](const PixelRectangle& pixels) {
    gl_->Scissor(pixels.left, pixels.bottom, pixels.right - pixels.left, pixels.top - pixels.bottom);
  };
  set_scissor(clip);
  gl_->BindTexture(GL_TEXTURE_2D, texture_name(command.GetTexID()));
  const auto draw_indices = [&](unsigned begin, unsigned end) {
    if (begin == end) return;
    constexpr GLenum index_type = sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    gl_->DrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(end - begin), index_type,
                                offset((command.IdxOffset + begin) * sizeof(ImDrawIdx)),
                                static_cast<GLint>(command.VtxOffset));
  };
  const ImDrawVert* const vertices = list.VtxBuffer.Data + command.VtxOffset;
  const ImDrawIdx* const indices = list.IdxBuffer.Data + command.IdxOffset;
  const bool has_atlas = texture_name(command.GetTexID()) == atlas_.id();
  unsigned drawn = 0, at = 0;
  while (has_atlas && at + 6 <= command.ElemCount) {
    const auto solid = find_solid(vertices, indices + at, white_, area);
    if (!solid) {
      at += 3;
      continue;
    }
    draw_indices(drawn, at);
    if (const PixelRectangle seen = solid->intersection(clip); !seen.empty()) {
      const ImVec4 colour = ImGui::ColorConvertU32ToFloat4(vertices[indices[at]].col);
      gl_->ClearColor(colour.x, colour.y, colour.z, colour.w);
      set_scissor(seen);
      gl_->Clear(GL_COLOR_BUFFER_BIT);
      set_scissor(clip);
    }
    drawn = at += 6;
  }
  draw_indices(drawn, command.ElemCount);
}

}  // namespace spoonbill
