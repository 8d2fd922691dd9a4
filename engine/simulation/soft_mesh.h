// A tessellated tool that gives way, as a body.
#pragma once

#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/scene/tool.h"
#include "engine/simulation/body_state.h"

namespace spoonbill {

// How long an edge may be, in lattice cells: a longer one would not follow a dent, and is halved first.
inline constexpr double soft_edge_cells = 0.5;

// Its lattice and its triangles, with nothing held. Refused with the field named: a mesh that passes through
// itself or that has, with edges so short, more than soft_mesh_triangle_limit triangles.
Result<BodyState> make_soft_mesh(const MeshSolid& solid, const SoftTool& soft, InstructionSet set);

}  // namespace spoonbill
