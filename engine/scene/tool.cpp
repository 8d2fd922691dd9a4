#include "engine/scene/tool.h"

#include <algorithm>
#include <climits>
#include <string>
#include <string_view>

#include "engine/collision/surfaces/closed_surface.h"

namespace spoonbill {
namespace {

// What an action goes by is a field of Tool, and no wider.
constexpr bool is_described(const ToolParameter& parameter) {
  for (const Field<Tool>& field : fields_of<Tool>) {
    if (std::string_view(field.form.name) != parameter.field) continue;
    return field.form.range.contains(parameter.range.low) && field.form.range.contains(parameter.range.high);
  }
  return false;
}

static_assert([] {
  for (const ToolActionRow& row : tool_actions) {
    for (const ToolParameter& parameter : row.parameters) {
      if (parameter.field != nullptr && !is_described(parameter)) return false;
    }
  }
  return true;
}());

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

Status check_soft(const ImplicitShape&) {
  return Error{"only a mesh or a B-spline surface can be soft; leave soft out"};
}

Status check_soft(const MeshSolid& solid) {
  const std::size_t triangles = solid.mesh.mesh.triangles.size();
  if (triangles > soft_mesh_triangle_limit) {
    return Error{"mesh: has " + std::to_string(triangles) + " triangles, a soft one at most " +
                 std::to_string(soft_mesh_triangle_limit) + "; reduce it, or leave soft out"};
  }
  const bool closed = std::all_of(solid.mesh.parts.begin(), solid.mesh.parts.end(),
                                  [](const MeshPart& part) { return part.closed; });
  if (!closed) return Error{"mesh: is not closed, as a soft one must be; close its holes, or leave soft out"};
  return {};
}

Status check_soft(const SurfaceSolid&) {
  return {};
}

}  // namespace

Status check_tool_body(const ToolBody& body) {
  Status solid = std::visit([](const auto& of) { return check_solid(of); }, body.solid);
  if (!solid.ok()) return solid;
  if (!body.soft) return {};
  Status soft = std::visit([](const auto& of) { return check_soft(of); }, body.solid);
  if (!soft.ok()) return soft;
  for (const Status& status : {check_material(body.soft->material), check_lattice_request(body.soft->lattice),
                               check_fixing_plane(body.soft->grip)}) {
    if (!status.ok()) return status;
  }
  return {};
}

Status check_tool(const Tool& tool) {
  if (Status status = check_fields("tool: ", tool); !status.ok()) return status;
  if (tool.kind != ToolKind::solid) return {};
  if (!tool.body) return Error{"tool: a solid must have a body"};
  const Status status = check_tool_body(*tool.body);
  return status.ok() ? status : Error{"tool: " + status.error().message};
}

}  // namespace spoonbill
