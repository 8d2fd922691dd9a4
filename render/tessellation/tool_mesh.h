// Rigid solid tools for drawing: triangle mesh, frame, extent, and the order in which glass is drawn. Does
// not use GL.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/tool.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Returns the body of a tool that is drawn as a rigid solid. Null for a point, for a sphere, and for a soft
// tool, which is one of the bodies of the snapshot.
const ToolBody* rigid_body(const ToolSnapshot& tool);
bool is_soft(const ToolSnapshot& tool);
// Returns whether a body of the snapshot is its soft tool.
bool is_tool_body(const Snapshot& snapshot, const BodySnapshot& body);

// Radius of the disc that represents a half-space, around its origin.
inline constexpr double half_space_radius_m = 0.05;

// Returns a box around the solid in its own frame; for a surface, the box around its control points.
Box bounding_box(const ToolSolid& solid);

// The transformation from the frame of the tool to the world: world = axes * local + origin_m. The axes are
// orthonormal, and left-handed for a mirror image.
struct ToolFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vector3 origin_m = Vector3::Zero();
};
ToolFrame tool_frame(const Snapshot& snapshot);
ToolFrame mirrored_tool_frame(const Snapshot& snapshot);

// Returns the point at which a ray from the centre of the box leaves the box, in world coordinates. `box` is
// in the coordinates of `frame`, and `direction` is a unit vector in world coordinates.
Vector3 find_exit_point(const Box& box, const ToolFrame& frame, const Vector3& direction);

struct ToolVertex {
  Eigen::Vector3f position_m;
  Eigen::Vector3f normal;  // unit normal, outward
};

// A triangle mesh in the frame of the tool. Each triangle has three indices, counter-clockwise seen from
// outside. Triangles share vertices where an implicit shape or a surface is smooth, but not along an edge,
// and not in a solid that is made of triangles. An open sheet has triangles on both sides.
struct ToolMesh {
  std::vector<ToolVertex> vertices;
  std::vector<std::uint32_t> indices;
  bool convex = false;  // true if no front face hides another: triangles may be drawn in any order
};

// Returns a mesh fine enough for a tool that fills the screen; empty for a sphere of radius 0. Errors: a
// surface that cannot be tessellated.
Result<ToolMesh> make_tool_mesh(const ToolSolid& solid);

// Sorts triangles for drawing glass from back to front. One owner, one thread.
class FacingOrder {
 public:
  // Returns the indices of the triangles that face the eye, the farthest centre first. `eye_m` is in the
  // frame of the mesh. The result is valid until the next call. The order may be wrong for triangles that are
  // long compared with their distance from each other, or whose distances from the eye differ by less than
  // 1/16384 of the range of distances.
  const std::vector<std::uint32_t>& sort(const ToolMesh& mesh, const Eigen::Vector3f& eye_m);

 private:
  struct Facing {
    float distance_m;
    std::uint32_t first_index;
  };
  void find_facing(const ToolMesh& mesh, const Eigen::Vector3f& eye_m);
  std::uint32_t bucket_index(float distance_m) const;

  std::vector<Facing> facing_;
  std::vector<std::uint32_t> ends_;  // working memory: ends of the buckets, the farthest bucket first
  std::vector<std::uint32_t> indices_;
  float farthest_m_ = 0.0F, buckets_per_m_ = 0.0F;
};

}  // namespace spoonbill
