#include "render/passes/surface_buffers.h"

#include <cstddef>

namespace spoonbill {

SurfaceBuffers::SurfaceBuffers(const GlFunctions& gl)
    : gl_(&gl), vertex_array_(make_vertex_array(gl)), vertices_(make_buffer(gl)), indices_(make_buffer(gl)) {}

void SurfaceBuffers::upload(const TessellatedSurface& surface) {
  const GridSamples<float>& samples = surface.samples();
  const std::size_t plane_bytes = surface.vertex_count() * sizeof(float);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(6 * plane_bytes), nullptr, GL_STREAM_DRAW);
  GLuint attribute = 0;
  for (const auto* plane : {&samples.x, &samples.y, &samples.z, &samples.nx, &samples.ny, &samples.nz}) {
    const std::size_t start = attribute * plane_bytes;
    gl_->BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(start), static_cast<GLsizeiptr>(plane_bytes),
                       plane->data());
    gl_->VertexAttribPointer(attribute, 1, GL_FLOAT, GL_FALSE, 0, reinterpret_cast<const void*>(start));
    gl_->EnableVertexAttribArray(attribute);
    ++attribute;
  }
  closed_ = surface.is_closed();
  if (topology_version_ == surface.topology_version()) return;
  topology_version_ = surface.topology_version();
  index_count_ = static_cast<GLsizei>(surface.indices().size());
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(surface.indices().size() * sizeof(std::uint32_t)),
                  surface.indices().data(), GL_STATIC_DRAW);
}

void SurfaceBuffers::draw() const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace spoonbill
