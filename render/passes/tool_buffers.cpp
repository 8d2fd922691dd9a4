#include "render/passes/tool_buffers.h"

#include <cstddef>
#include <utility>

#include "render/overlay/solid_tool.h"

namespace spoonbill {

ToolBuffers::ToolBuffers(const GlFunctions& gl)
    : gl_(&gl), vertex_array_(make_vertex_array(gl)), vertices_(make_buffer(gl)), indices_(make_buffer(gl)) {}

Status ToolBuffers::update(const ToolSnapshot& tool) {
  if (rigid_body(tool) == nullptr || tool.body == body_) return {};
  Result<ToolMesh> mesh = make_tool_mesh(tool.body->solid);
  if (!mesh) return mesh.error();
  mesh_ = std::move(mesh).value();
  body_ = tool.body;
  upload();
  return {};
}

void ToolBuffers::upload() const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh_.vertices.size() * sizeof(ToolVertex)),
                  mesh_.vertices.data(), GL_STATIC_DRAW);
  constexpr GLsizei stride = sizeof(ToolVertex);
  gl_->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, nullptr);
  gl_->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride,
                           reinterpret_cast<const void*>(offsetof(ToolVertex, normal)));
  gl_->EnableVertexAttribArray(0);
  gl_->EnableVertexAttribArray(1);
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(mesh_.indices.size() * sizeof(std::uint32_t)), mesh_.indices.data(),
                  GL_STATIC_DRAW);
}

void ToolBuffers::draw(const Eigen::Vector3f& eye_m) {
  gl_->BindVertexArray(vertex_array_.id());
  std::size_t count = mesh_.indices.size();
  if (!mesh_.convex) {
    const std::vector<std::uint32_t>& ordered = order_.of(mesh_, eye_m);
    count = ordered.size();
    gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
    gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(std::uint32_t)),
                    ordered.data(), GL_STREAM_DRAW);
  }
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, nullptr);
}

}  // namespace spoonbill
