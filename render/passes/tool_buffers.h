// The mesh of a rigid solid tool, held in GL buffers for as long as the tool stays the same.
#pragma once

#include <memory>

#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/tessellation/facing_order.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {

class ToolBuffers {
 public:
  explicit ToolBuffers(const GlFunctions& gl);

  // Makes and uploads the mesh when the tool has another body than at the last call; until then does nothing.
  // The error is that of a solid that has no mesh.
  Status update(const ToolSnapshot& tool);

  // Nothing to draw.
  bool empty() const { return mesh_.indices.empty(); }

  // Draws with the program in use what the eye, in the tool's frame, can see, the far before the near.
  void draw(const Eigen::Vector3f& eye_m);

 private:
  void upload() const;

  const GlFunctions* gl_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  GlHandle indices_;
  std::shared_ptr<const ToolBody> body_;  // kept, so that no other can take its place in memory
  ToolMesh mesh_;
  FacingOrder order_;
};

}  // namespace spoonbill
