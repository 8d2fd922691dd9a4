// A tessellated surface in GL buffers: planar attributes (x, y, z, nx, ny, nz at locations 0 to 5) and
// indices.
#pragma once

#include <cstdint>

#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

class SurfaceBuffers {
 public:
  explicit SurfaceBuffers(const GlFunctions& gl);

  // Takes over the samples, and the indices where the topology changed. Old storage is orphaned: overwriting
  // it would wait for the frame that still reads it.
  void upload(const TessellatedSurface& surface);

  // Draws with the program in use.
  void draw() const;

  bool is_closed() const { return closed_; }

 private:
  const GlFunctions* gl_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  GlHandle indices_;
  GLsizei index_count_ = 0;
  std::uint64_t topology_version_ = 0;
  bool closed_ = false;
};

}  // namespace spoonbill
