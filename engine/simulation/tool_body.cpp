#include "engine/simulation/tool_body.h"

#include <algorithm>
#include <climits>

#include "engine/simulation/scene.h"

namespace spoonbill {
namespace {

Error of_tool(const Error& error) {
  return Error{"tool: " + error.message};
}

Status check_solid(const ImplicitShape& shape) {
  return check_implicit_shape(shape);
}

Status check_solid(const MeshSolid& solid) {
  return check_range("mesh: triangles",
                     static_cast<int>(std::min<std::size_t>(solid.mesh.mesh.triangles.size(), INT_MAX)),
                     Range<int>{1, tool_triangle_limit});
}

Status check_solid(const SurfaceSolid& solid) {
  return check_closed_tube(solid.surface);
}

}  // namespace

Status check_tool_body(const ToolBody& body) {
  const Status solid = std::visit([](const auto& of) { return check_solid(of); }, body.solid);
  if (!solid.ok()) return of_tool(solid.error());
  if (!body.soft) return {};
  if (!std::holds_alternative<SurfaceSolid>(body.solid)) {
    return Error{"tool: only a B-spline surface can be soft; leave soft out"};
  }
  for (const Status& status : {check_material(body.soft->material), check_lattice_request(body.soft->lattice),
                               check_fixing_plane(body.soft->grip)}) {
    if (!status.ok()) return of_tool(status.error());
  }
  return {};
}

}  // namespace spoonbill
