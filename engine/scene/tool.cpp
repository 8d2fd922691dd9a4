#include "engine/scene/tool.h"

#include <algorithm>
#include <climits>
#include <string>
#include <string_view>

#include "engine/collision/surfaces/closed_surface.h"

namespace spoonbill {
namespace {

// Returns true if Tool has a field with the parameter's name, and the field's range contains the parameter's
// range.
constexpr bool is_tool_field(const ToolParameter& parameter) {
  for (const Field<Tool>& field : fields_of<Tool>) {
    if (std::string_view(field.form.name) != parameter.field) continue;
    return field.form.range.contains(parameter.range.low) && field.form.range.contains(parameter.range.high);
  }
  return false;
}

static_assert(
    [] {
      for (const ToolActionRow& row : tool_actions) {
        for (const ToolParameter& parameter : row.parameters) {
          if (parameter.field != nullptr && !is_tool_field(parameter)) return false;
        }
      }
      return true;
    }(),
    "the parameters of tool_actions must be fields of Tool, within their ranges");

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
  return Error{ErrorCode::unsupported, "only a mesh or a B-spline surface can be soft; omit soft", "soft"};
}

Status check_soft(const MeshSolid& solid) {
  const std::size_t triangles = solid.mesh.mesh.triangles.size();
  if (triangles > soft_mesh_triangle_limit) {
    return Error{ErrorCode::too_many,
                 "mesh: has " + std::to_string(triangles) + " triangles, but a soft mesh may have at most " +
                     std::to_string(soft_mesh_triangle_limit) + "; reduce it or omit soft",
                 "mesh"};
  }
  const bool closed = std::all_of(solid.mesh.parts.begin(), solid.mesh.parts.end(),
                                  [](const MeshPart& part) { return part.closed; });
  if (!closed) {
    return Error{ErrorCode::inconsistent,
                 "mesh: is open, but a soft mesh must be closed; close its holes or omit soft", "mesh"};
  }
  return {};
}

Status check_soft(const SurfaceSolid&) {
  return {};
}

}  // namespace

Status check_tool_body(const ToolBody& body) {
  Status solid = std::visit([](const auto& shape) { return check_solid(shape); }, body.solid);
  if (!solid.ok()) return solid;
  if (!body.soft) return {};
  Status soft = std::visit([](const auto& shape) { return check_soft(shape); }, body.solid);
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
  if (!tool.body) return Error{ErrorCode::missing, "tool: a solid must have a body", "solid"};
  const Status status = check_tool_body(*tool.body);
  return status.ok() ? status : status.error().in("tool");
}

}  // namespace spoonbill
