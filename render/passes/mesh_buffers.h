// The meshes of bodies and tool in GL buffers, which persist from frame to frame.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/gl/pipeline.h"
#include "render/overlay/fixed_tint.h"
#include "render/tessellation/ambient_occlusion.h"
#include "render/tessellation/reach_ring.h"
#include "render/tessellation/tessellated_surface.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {

// A tessellated surface in GL buffers: the indices, and a separate array for each attribute (x, y, z, nx, ny,
// nz, visibility of both sides, and tint at locations 0 to 8).
class SurfaceBuffers {
 public:
  explicit SurfaceBuffers(const GlFunctions& gl);

  // Uploads the samples, and the indices if the topology has changed. The old storage is orphaned, because
  // overwriting it would wait for the frame that still reads it.
  // `visibility` and `tint` have a value for each vertex (see AmbientOcclusion and FixedTint).
  void upload(const TessellatedSurface& surface, const BothSides& visibility, const std::vector<float>& tint);

  // Draws the surface with the program in use.
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

// How the surfaces of a snapshot are prepared.
struct MeshChoice {
  // Keeps the tessellation while it is neither too coarse nor much too fine, and lets the visibility of the
  // vertices follow the bodies within a few frames.
  bool keeps_level = true;
  bool is_occluded = true;   // computes visibility; otherwise it is 1
  bool shows_fixed = false;  // computes the tint of the fixed part; otherwise it is 0
  bool shows_reach = false;  // finds the ring of a local stroke
};

// The surfaces of a snapshot, tessellated for the screen.
class BodyMeshes {
 public:
  explicit BodyMeshes(const GlFunctions& gl) : gl_(&gl) {}

  // Updates all surfaces to the snapshot. Returns the error of the first surface that cannot be tessellated.
  Status update(const Snapshot& snapshot, double pixels_per_metre, const MeshChoice& choice);

  const std::vector<TessellatedSurface>& surfaces() const { return surfaces_; }
  const std::vector<SurfaceBuffers>& buffers() const { return buffers_; }
  // The ring of a local stroke on each surface. Those without one have no ends.
  const std::vector<ReachRing>& rings() const { return rings_; }
  const Box& bounds() const { return bounds_; }

 private:
  const GlFunctions* gl_;
  std::vector<TessellatedSurface> surfaces_;
  std::vector<SurfaceBuffers> buffers_;
  AmbientOcclusion occlusion_;
  std::vector<FixedTint> tints_;
  std::vector<ReachRing> rings_;
  BothSides open_;               // visibility without occlusion
  std::vector<float> untinted_;  // tint without a fixed part
  Box bounds_;
};

// The mesh of a rigid solid tool.
class ToolBuffers {
 public:
  explicit ToolBuffers(const GlFunctions& gl);

  // Builds and uploads the mesh if the tool is a rigid solid and its body has changed since the last call.
  // Returns the error of a solid that has no mesh.
  Status update(const ToolSnapshot& tool);

  bool empty() const { return mesh_.indices.empty(); }

  // Draws the tool with the program in use. If the mesh is not convex, draws only the triangles that face the
  // eye, from back to front. `eye_m` is in the frame of the tool.
  void draw(const Eigen::Vector3f& eye_m);

 private:
  void upload() const;

  const GlFunctions* gl_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  GlHandle indices_;
  // Shared ownership, so that no other body can get this address, which update() compares.
  std::shared_ptr<const ToolBody> body_;
  ToolMesh mesh_;
  FacingOrder order_;
};

}  // namespace spoonbill
