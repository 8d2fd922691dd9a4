// Model of a tool, which is made from its body outside the tick.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/signed_distance.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// Longest edge of a soft mesh, in lattice cells. Longer edges would not follow a dent and are halved.
inline constexpr double soft_edge_cells = 0.5;

// Makes the body of a soft tool from triangles, with no node fixed. Refuses a mesh that passes through itself
// or has an edge of more than two triangles. Also refuses a mesh that has more than soft_mesh_triangle_limit
// triangles once its edges are short enough. The error names the field.
Result<BodyState> make_soft_mesh(const MeshSolid& solid, const SoftTool& soft, InstructionSet set);

// Body of a tool prepared for contact; empty for a point or a sphere. Made outside the tick, owned by a
// simulation.
struct ToolModel {
  std::shared_ptr<const SignedDistance> distance;  // only for rigid implicit or tessellated tools
  std::shared_ptr<const Surface> surface;          // only for rigid B-spline tools, in the tool's frame
  std::shared_ptr<const NestedGrid> nested;        // grid of the samples of `surface`
  // Upper bound of the distance of the tool's points from the origin of its frame. It is limited to 0.1 m for
  // implicit and tessellated tools.
  double extent_m = 0.0;
  std::optional<BodyState> soft;  // only for soft tools, with the rest shape in the tool's frame
  std::vector<int> gripped;       // nodes of `soft` that are fixed to the hand
  // Only for soft meshes; shared with snapshots.
  std::shared_ptr<const std::vector<TriangleCorners>> triangles;
};

// Returns the body from which a tool's model is made; null for a point or a sphere.
inline std::shared_ptr<const ToolBody> find_model_body(const Tool& tool) {
  return tool.kind == ToolKind::solid ? tool.body : nullptr;
}

// Makes the model of a tool. Refuses a body that cannot be simulated; the error names the field.
Result<ToolModel> make_tool_model(const Tool& tool, InstructionSet set);

}  // namespace spoonbill
