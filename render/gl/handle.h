// Owners of GL objects: each deletes its object at the end of its life, while the context must be current.
// Movable, not copyable; the function table must outlive them.
#pragma once

#include <utility>

#include "render/gl/functions.h"

namespace spoonbill {

class GlHandle {
 public:
  using Destroy = void (*)(const GlFunctions& gl, GLuint id);

  GlHandle() = default;
  GlHandle(const GlFunctions& gl, GLuint id, Destroy destroy) : gl_(&gl), id_(id), destroy_(destroy) {}
  GlHandle(GlHandle&& other) noexcept
      : gl_(other.gl_), id_(std::exchange(other.id_, 0)), destroy_(other.destroy_) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    if (this != &other) {
      reset();
      gl_ = other.gl_;
      id_ = std::exchange(other.id_, 0);
      destroy_ = other.destroy_;
    }
    return *this;
  }
  ~GlHandle() { reset(); }

  // 0 when empty.
  GLuint id() const { return id_; }

 private:
  void reset() {
    if (id_ != 0) destroy_(*gl_, id_);
    id_ = 0;
  }

  const GlFunctions* gl_ = nullptr;
  GLuint id_ = 0;
  Destroy destroy_ = nullptr;
};

GlHandle make_buffer(const GlFunctions& gl);
GlHandle make_vertex_array(const GlFunctions& gl);
GlHandle make_texture(const GlFunctions& gl);
GlHandle make_renderbuffer(const GlFunctions& gl);
GlHandle make_framebuffer(const GlFunctions& gl);

}  // namespace spoonbill
