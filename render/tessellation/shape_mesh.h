// The triangles of implicit shapes. No GL.
#pragma once

#include "render/tessellation/tool_mesh.h"

namespace spoonbill {

ToolMesh make_shape_mesh(const ImplicitShape& shape);

}  // namespace spoonbill
