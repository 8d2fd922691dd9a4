// The snapshot's surfaces, tessellated for the screen and held in GL buffers from frame to frame.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/passes/surface_buffers.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

class BodyMeshes {
 public:
  explicit BodyMeshes(const GlFunctions& gl) : gl_(&gl) {}

  // Follows the snapshot; `keep_level` lets the last frame's tessellation stay while it is near enough. The
  // error is that of the first surface that cannot be tessellated.
  Status update(const Snapshot& snapshot, double pixels_per_metre, bool keep_level);

  const std::vector<TessellatedSurface>& surfaces() const { return surfaces_; }
  const std::vector<SurfaceBuffers>& buffers() const { return buffers_; }
  const Box& bounds() const { return bounds_; }

 private:
  const GlFunctions* gl_;
  std::vector<TessellatedSurface> surfaces_;
  std::vector<SurfaceBuffers> buffers_;
  Box bounds_;
};

}  // namespace spoonbill
