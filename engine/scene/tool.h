// The tool: its shape, what it does where it touches, and what it is made of. Plain data; lengths in metres.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/implicit/implicit_shapes.h"
#include "engine/scene/fixing_plane.h"
#include "engine/scene/lattice_request.h"
#include "engine/scene/material.h"

namespace spoonbill {

enum class ToolKind { point, sphere, solid };
enum class ToolAction { push, pull, smooth };

// As files and labels call them.
constexpr const char* name_of(ToolKind kind) {
  return kind == ToolKind::point ? "point" : kind == ToolKind::sphere ? "sphere" : "solid";
}
constexpr const char* name_of(ToolAction action) {
  return action == ToolAction::push ? "push" : action == ToolAction::pull ? "pull" : "smooth";
}

// A closed tube.
struct SurfaceSolid {
  Surface surface;
};

// Triangles, cleaned (triangle_mesh.h).
struct MeshSolid {
  CleanMesh mesh;
};

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

inline constexpr Range<double> tool_radius_range_m{0.0, 0.5};
inline constexpr Range<int> tool_iterations_range{1, 8};

// Each names the field of the first thing that is wrong.
Status check_tool_body(const ToolBody& body);
Status check_tool(const Tool& tool);

}  // namespace spoonbill
