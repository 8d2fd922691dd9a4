// What tools are made of besides a point and a sphere. Plain data that never changes once made: the tool's
// own frame, lengths in metres.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/implicit/implicit_shapes.h"
#include "engine/material/lattice/lattice_request.h"
#include "engine/material/material.h"
#include "engine/simulation/fixing_plane.h"

namespace spoonbill {

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

struct ToolBody {
  ToolSolid solid;
  std::optional<SoftTool> soft;  // rigid without
};

// Names the field of the first thing that is wrong.
Status check_tool_body(const ToolBody& body);

}  // namespace spoonbill
