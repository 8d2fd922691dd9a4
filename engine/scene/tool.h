// The tool: its shape, what it does where it touches, and what it is made of. Plain data; lengths in metres.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <variant>

#include "engine/base/field.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/implicit_shapes.h"
#include "engine/scene/fixing_plane.h"
#include "engine/scene/lattice_request.h"
#include "engine/scene/material.h"
#include "engine/scene/tool_actions.h"

namespace spoonbill {

// A closed tube.
struct SurfaceSolid {
  Surface surface;
};

// Triangles, cleaned (triangle_mesh.h).
struct MeshSolid {
  CleanMesh mesh;
};

template <>
inline constexpr const char* kind_name<MeshSolid> = "mesh";
template <>
inline constexpr const char* kind_name<SurfaceSolid> = "surface";

using ToolSolid = std::variant<ImplicitShape, MeshSolid, SurfaceSolid>;

// What a document may hold of a mesh.
inline constexpr int tool_triangle_limit = 200000;
// What of a soft one is moved and searched in every tick of a millisecond.
inline constexpr int soft_mesh_triangle_limit = 20000;

// A tool that gives way: a lattice of its own, held by the hand behind a plane.
struct SoftTool {
  Material material;
  LatticeRequest lattice;
  FixingPlane grip;  // in the tool's frame
};

// A tool besides a point and a sphere, in its own frame; never changes once made.
struct ToolBody {
  ToolSolid solid;
  std::optional<SoftTool> soft;  // rigid without
};

struct Tool {
  ToolKind kind = ToolKind::sphere;
  ToolAction action = ToolAction::push;
  double radius_m = 0.008;  // of a sphere; 0 for a point; how far smoothing reaches with a solid
  int iterations = 6;       // relaxation steps a tick: few act locally, many globally (1 to 8)
  std::shared_ptr<const ToolBody> body = {};  // of a solid; may stay while the tool is another
};

// What this tool's action takes of a field of it, named as in files; what any takes where it goes without.
inline Range<double> range_in_action(const Tool& tool, const char* field, Range<double> any) {
  const ToolParameter* parameter = parameter_of(tool.action, field);
  return parameter == nullptr ? any : parameter->range;
}

// Before its body, which files hold as "solid" and "soft".
template <>
inline constexpr auto fields_of<Tool> = std::to_array<Field<Tool>>({
    choice_field<&Tool::kind>("kind", tool_kind_names),
    choice_field<&Tool::action>("action", tool_action_names),
    number_field("radius_mm", &Tool::radius_m, tool_radius_range_m, FieldUnit::metre)
        .with_slider({"Radius", {0.001, 0.05}, true})
        .with_range_by([](const Tool& tool) {
          return range_in_action(tool, "radius_mm", tool_radius_range_m);
        }),
    whole_number_field("iterations", &Tool::iterations, tool_iterations_range, FieldUnit::per_tick)
        .with_slider({"Iterations", {1.0, 8.0}, false})
        .with_range_by([](const Tool& tool) {
          return range_in_action(tool, "iterations", {1.0, 8.0});
        }),
});

// Each names the field of the first thing that is wrong.
Status check_tool_body(const ToolBody& body);
Status check_tool(const Tool& tool);

}  // namespace spoonbill
