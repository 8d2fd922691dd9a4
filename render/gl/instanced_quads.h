// A quad for each of many instances, whose vertex shader places it: six vertices told apart by gl_VertexID,
// and the instance's own attributes at locations 0, 1, ...
#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

#include "render/gl/functions.h"
#include "render/gl/handle.h"

namespace spoonbill {

// One attribute within an instance. Unsigned bytes reach the shader as 0 to 1.
struct InstanceAttribute {
  GLint components = 1;
  GLenum type = GL_FLOAT;
  std::size_t offset_bytes = 0;
};

class InstancedQuads {
 public:
  // The context must be current here and in draw().
  InstancedQuads(const GlFunctions& gl, std::size_t instance_bytes,
                 std::initializer_list<InstanceAttribute> attributes);

  // Draws with the program in use. `Instance` has the size and layout that the attributes describe.
  template <class Instance>
  void draw(const std::vector<Instance>& instances) const {
    draw(instances.data(), instances.size());
  }

 private:
  void draw(const void* instances, std::size_t count) const;

  const GlFunctions* gl_;
  std::size_t instance_bytes_;
  GlHandle vertex_array_;
  GlHandle instances_;
};

}  // namespace spoonbill
