// A tool's body made ready for contact.
#pragma once

#include <memory>
#include <optional>

#include "engine/base/processor.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/signed_distance.h"
#include "engine/scene/scene.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// Empty for a point and a sphere. Built outside the tick; a simulation owns it.
struct ToolModel {
  std::shared_ptr<const SignedDistance> distance;  // of a rigid implicit or tessellated one
  std::shared_ptr<const Surface> surface;          // of a rigid B-spline tool, in its frame
  std::shared_ptr<const NestedGrid> nested;        // its samples
  double extent_m = 0.0;                           // the farthest of it from its frame's origin
  std::optional<BodyState> soft;  // of one that gives way; its rest shape is in the tool's frame
  std::vector<int> gripped;       // its nodes that the hand holds
  std::shared_ptr<const std::vector<TriangleCorners>> triangles;  // of a soft mesh; snapshots share them

  bool is_soft() const { return soft.has_value(); }
};

// The body that a tool needs a model of; none for a point and a sphere.
inline std::shared_ptr<const ToolBody> modelled_body(const Tool& tool) {
  return tool.kind == ToolKind::solid ? tool.body : nullptr;
}

// Refused with the field named where the body cannot be simulated.
Result<ToolModel> make_tool_model(const Tool& tool, InstructionSet set);

}  // namespace spoonbill
