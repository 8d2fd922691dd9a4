#include "render/gl/instanced_quads.h"

namespace spoonbill {

InstancedQuads::InstancedQuads(const GlFunctions& gl, std::size_t instance_bytes,
                               std::initializer_list<InstanceAttribute> attributes)
    : gl_(&gl),
      instance_bytes_(instance_bytes),
      vertex_array_(make_vertex_array(gl)),
      instances_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  GLuint location = 0;
  for (const InstanceAttribute& attribute : attributes) {
    gl.VertexAttribPointer(location, attribute.components, attribute.type,
                           attribute.type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE,
                           static_cast<GLsizei>(instance_bytes),
                           reinterpret_cast<const void*>(attribute.offset_bytes));
    gl.EnableVertexAttribArray(location);
    gl.VertexAttribDivisor(location, 1);
    ++location;
  }
}

void InstancedQuads::draw(const void* instances, std::size_t count) const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * instance_bytes_), instances,
                  GL_STREAM_DRAW);
  gl_->DrawArraysInstanced(GL_TRIANGLES, 0, 6, static_cast<GLsizei>(count));
}

}  // namespace spoonbill
