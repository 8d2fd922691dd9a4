// The sculpting tool: its shape, its action and its material. Plain data; lengths in metres.
//
// The table `tool_actions` defines the actions for files, commands, the panel, keys, help and JSON schema. A
// new action needs an enumerator and a row here, and a kernel in engine/simulation/tool_step.cpp, which
// performs the action in a tick.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/implicit_shapes.h"
#include "engine/scene/body.h"
#include "engine/scene/loads.h"
#include "engine/scene/material.h"

namespace spoonbill {

enum class ToolKind { point, sphere, solid };
enum class ToolAction { push, pull, smooth };
// How far a stroke that pushes or pulls reaches. `whole`: the material deforms, and what is not fixed may
// move and bend. `local`: the material near the touched point is shaped, and everything else keeps its place.
enum class ToolReach { whole, local };

// Behaviour of a tool that pushes while the button is down. `hold`: it keeps hold of what it
// touches and does not slide off sideways; along the normal it still only pushes. `slide`: it slides.
enum class ToolGlide { hold, slide };

// Names of the tool kinds, in files and as labels.
inline constexpr const char* tool_kind_names[] = {"point", "sphere", "solid"};

inline constexpr const char* tool_reach_names[] = {"whole", "local"};
inline constexpr const char* tool_glide_names[] = {"hold", "slide"};

inline constexpr Range<double> tool_radius_range_m{0.0, 0.5};
inline constexpr Range<int> tool_substeps_range{1, 8};

// A field of Tool that an action uses, identified by its name in files, and the range that the action
// accepts, in SI units.
struct ToolParameter {
  const char* field = nullptr;
  Range<double> range{0.0, 0.0};
};

// Key of the window, a digit or a capital letter. It selects a kind of tool, and the action of the
// ToolActionRow that contains the key.
struct ToolKey {
  const char* key = nullptr;  // null if there is no key
  ToolKind kind = ToolKind::sphere;
  const char* help = nullptr;
};

struct ToolActionRow {
  ToolAction action;
  const char* name;   // name in files
  const char* label;  // label in the panel
  const char* help;   // one sentence without a full stop
  // True if the tool grips the surface at the first contact and holds it until the button is released. False
  // if the surface is released when the tool moves away.
  bool grips;
  bool allows_soft_tool;
  ToolAction inverse;  // action while Ctrl is down; equal to `action` if there is no inverse
  std::array<ToolParameter, 4> parameters;
  std::array<ToolKey, 2> keys;
};

inline constexpr ToolParameter radius_parameter{"radius_mm", tool_radius_range_m};
inline constexpr ToolParameter substeps_parameter{"substeps", {1.0, 8.0}};
inline constexpr ToolParameter local_radius_parameter{"local_radius_mm", tool_radius_range_m};

// The actions, in the order of the enumeration ToolAction.
inline constexpr auto tool_actions = std::to_array<ToolActionRow>({
    {.action = ToolAction::push,
     .name = "push",
     .label = "Push",
     .help = "Keeps the surface out of the tool and never pulls it",
     .grips = false,
     .allows_soft_tool = true,
     .inverse = ToolAction::pull,
     .parameters = {radius_parameter, substeps_parameter, local_radius_parameter},
     .keys = {{{"1", ToolKind::sphere, "Sphere that pushes"}, {"3", ToolKind::point, "Point that pushes"}}}},
    {.action = ToolAction::pull,
     .name = "pull",
     .label = "Pull",
     .help = "Grips what it first touches, and holds it until the button is released",
     .grips = true,
     .allows_soft_tool = false,
     .inverse = ToolAction::push,
     .parameters = {radius_parameter, substeps_parameter, local_radius_parameter},
     .keys = {{{"2", ToolKind::sphere, "Sphere that pulls"}, {"4", ToolKind::point, "Point that pulls"}}}},
    {.action = ToolAction::smooth,
     .name = "smooth",
     .label = "Smooth",
     .help = "Smooths the surface within the radius",
     .grips = false,
     .allows_soft_tool = false,
     .inverse = ToolAction::smooth,
     .parameters = {radius_parameter, substeps_parameter},
     .keys = {{{"5", ToolKind::sphere, "Sphere that smooths"}}}},
});

static_assert(
    [] {
      for (std::size_t a = 0; a < tool_actions.size(); ++a) {
        if (static_cast<std::size_t>(tool_actions[a].action) != a) return false;
      }
      return true;
    }(),
    "tool_actions must list the actions in the order of the enumeration");

constexpr const ToolActionRow& row_of(ToolAction action) {
  return tool_actions[static_cast<std::size_t>(action)];
}

constexpr const char* name_of(ToolKind kind) {
  return tool_kind_names[static_cast<std::size_t>(kind)];
}
constexpr const char* name_of(ToolAction action) {
  return row_of(action).name;
}

// Names and labels of the actions, in the order of the table.
inline constexpr auto tool_action_names = [] {
  std::array<const char*, tool_actions.size()> names{};
  for (std::size_t a = 0; a < names.size(); ++a) names[a] = tool_actions[a].name;
  return names;
}();
inline constexpr auto tool_action_labels = [] {
  std::array<const char*, tool_actions.size()> labels{};
  for (std::size_t a = 0; a < labels.size(); ++a) labels[a] = tool_actions[a].label;
  return labels;
}();

// Returns the parameter of an action for a field of Tool; null if the action does not use the field.
constexpr const ToolParameter* find_tool_parameter(ToolAction action, std::string_view field) {
  for (const ToolParameter& parameter : row_of(action).parameters) {
    if (parameter.field != nullptr && field == parameter.field) return &parameter;
  }
  return nullptr;
}

// A solid bounded by a B-spline tube with closed ends.
struct SurfaceSolid {
  Surface surface;
};

// A solid bounded by a cleaned triangle mesh (see CleanMesh).
struct MeshSolid {
  CleanMesh mesh;
};

template <>
inline constexpr const char* kind_name<MeshSolid> = "mesh";
template <>
inline constexpr const char* kind_name<SurfaceSolid> = "surface";

using ToolSolid = std::variant<ImplicitShape, MeshSolid, SurfaceSolid>;

// Largest number of triangles of a tool's mesh in a document.
inline constexpr int tool_triangle_limit = 200000;
// Largest number of triangles of a soft tool's mesh. It is small, because the mesh is moved and searched in
// every tick of one millisecond.
inline constexpr int soft_mesh_triangle_limit = 20000;

// A deformable tool with its own lattice. The nodes behind the plane `grip` move with the hand.
struct SoftTool {
  Material material;
  LatticeRequest lattice;
  FixingPlane grip;  // plane in the tool's frame; the hand holds the nodes behind it
};

// Body of a tool of the kind `solid`, in the tool's frame. Immutable once made.
struct ToolBody {
  ToolSolid solid;
  std::optional<SoftTool> soft;  // properties of a soft tool; empty if the tool is rigid
};

struct Tool {
  ToolKind kind = ToolKind::sphere;
  ToolAction action = ToolAction::push;
  // Radius of a sphere; 0 for a point. For a solid that smooths: radius of the smoothed area around the
  // surface point nearest to the tool.
  double radius_m = 0.008;
  int substeps = 6;  // substeps per tick, 1 to 8; with more substeps, bodies respond faster
  // Body of the tool. Required for the kind `solid`; may be kept while another kind is in use.
  std::shared_ptr<const ToolBody> body = {};
  ToolReach reach = ToolReach::whole;
  ToolGlide sideways = ToolGlide::hold;
  // Radius of a local stroke along the surface; 0 chooses 1.5 times the radius of the tool's contact.
  double local_radius_m = 0.0;

  bool is_local() const { return reach == ToolReach::local && action != ToolAction::smooth; }
};

// Returns the radius of the contact of a tool with a local reach. A tool that pulls holds what is inside its
// radius. A sphere that pushes touches a disc of 0.6 times its radius when it is in by a fifth of its radius.
inline double contact_radius_m(const Tool& tool) {
  const double radius_m = tool.kind == ToolKind::point ? 0.0 : tool.radius_m;
  return tool.action == ToolAction::pull ? radius_m : 0.6 * radius_m;
}

// Returns the range that the tool's action accepts for a field; `any` if the action does not use the field.
// `field` is the field's name in files.
inline Range<double> range_in_action(const Tool& tool, const char* field, Range<double> any) {
  const ToolParameter* parameter = find_tool_parameter(tool.action, field);
  return parameter == nullptr ? any : parameter->range;
}

// Fields of a tool except its body. Files store the body in two fields, "solid" and "soft".
template <>
inline constexpr auto fields_of<Tool> = std::to_array<Field<Tool>>({
    choice_field<&Tool::kind>("kind", tool_kind_names),
    choice_field<&Tool::action>("action", tool_action_names),
    number_field("radius_mm", &Tool::radius_m, tool_radius_range_m, FieldUnit::metre)
        .with_slider({"Radius", {0.001, 0.05}, true})
        .with_range_by([](const Tool& tool) {
          return range_in_action(tool, "radius_mm", tool_radius_range_m);
        }),
    whole_number_field("substeps", &Tool::substeps, tool_substeps_range, FieldUnit::per_tick)
        .with_slider({"Substeps", {1.0, 8.0}, false})
        .with_range_by([](const Tool& tool) {
          return range_in_action(tool, "substeps", {1.0, 8.0});
        }),
    choice_field<&Tool::reach>("reach", tool_reach_names).optional(),
    choice_field<&Tool::sideways>("sideways", tool_glide_names).optional(),
    number_field("local_radius_mm", &Tool::local_radius_m, tool_radius_range_m, FieldUnit::metre)
        .optional()
        .with_slider({"Local radius", {0.001, 0.05}, true}),
});

// Returns an error that names the first field at fault.
Status check_tool_body(const ToolBody& body);
Status check_tool(const Tool& tool);

}  // namespace spoonbill
