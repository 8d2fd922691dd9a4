// Where a rigid solid tool is and how much room it takes. No GL.
#pragma once

#include "engine/scene/tool.h"
#include "engine/simulation/snapshot.h"
#include "render/camera.h"

namespace spoonbill {

// The tool's body where it is drawn as a rigid solid; null for a point, for a sphere, and for a soft tool,
// which is one of the snapshot's bodies.
const ToolBody* rigid_body(const ToolSnapshot& tool);
bool is_soft(const ToolSnapshot& tool);

// How much of a half-space is drawn: a disc about its origin.
inline constexpr double half_space_radius_m = 0.05;

// Around the solid in its own frame; around the control points where it is a surface, which lies within.
Box bounding_box(const ToolSolid& solid);

// From the tool's frame to the world: world = axes * local + origin_m. The axes are orthonormal, and
// left-handed where the tool is the mirror image.
struct ToolFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vector3 origin_m = Vector3::Zero();
};
ToolFrame tool_frame(const Snapshot& snapshot);
ToolFrame mirrored_tool_frame(const Snapshot& snapshot);

// Where a ray from the middle of the box, along a unit direction of the world, leaves it.
Vector3 way_out(const Box& box, const ToolFrame& frame, const Vector3& direction);

}  // namespace spoonbill
