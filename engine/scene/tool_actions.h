// What a tool can do where it touches, in one table: files, commands, the panel, the window's keys, the help
// and the JSON schema go by it. What an action does in a tick is its kernel in engine/simulation/
// tool_actions, one file each; an action without one does not link.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "engine/base/geometry.h"

namespace spoonbill {

enum class ToolKind { point, sphere, solid };
enum class ToolAction { push, pull, smooth };

// As files and labels call them.
inline constexpr const char* tool_kind_names[] = {"point", "sphere", "solid"};

inline constexpr Range<double> tool_radius_range_m{0.0, 0.5};
inline constexpr Range<int> tool_iterations_range{1, 8};

// A field of Tool that an action goes by, and what it takes of it, SI; named as in files.
struct ToolParameter {
  const char* field = nullptr;
  Range<double> range{0.0, 0.0};
};

// A key of the window, a digit or a capital, that takes up a tool of a kind with the action.
struct ToolKey {
  const char* key = nullptr;  // none
  ToolKind kind = ToolKind::sphere;
  const char* help = nullptr;
};

struct ToolActionRow {
  ToolAction action;
  const char* name;   // in files
  const char* label;  // in the panel
  const char* help;   // what it does, as a sentence without a full stop
  // Whether it holds what it first touches until the button is released; others let go as the tool leaves.
  bool grips;
  bool with_soft_tool;  // whether a tool that gives way can do it
  ToolAction inverse;   // what Ctrl makes of it; itself where it has none
  std::array<ToolParameter, 4> parameters;
  std::array<ToolKey, 2> keys;
};

inline constexpr ToolParameter radius_parameter{"radius_mm", tool_radius_range_m};
inline constexpr ToolParameter iterations_parameter{"iterations", {1.0, 8.0}};

// In the order of the enumeration.
inline constexpr auto tool_actions = std::to_array<ToolActionRow>({
    {.action = ToolAction::push,
     .name = "push",
     .label = "Push",
     .help = "Keeps the surface out of the tool, and lets go as it leaves",
     .grips = false,
     .with_soft_tool = true,
     .inverse = ToolAction::pull,
     .parameters = {radius_parameter, iterations_parameter},
     .keys = {{{"1", ToolKind::sphere, "Sphere that pushes"}, {"3", ToolKind::point, "Point that pushes"}}}},
    {.action = ToolAction::pull,
     .name = "pull",
     .label = "Pull",
     .help = "Grips what it first touches, and holds it until the button is released",
     .grips = true,
     .with_soft_tool = false,
     .inverse = ToolAction::push,
     .parameters = {radius_parameter, iterations_parameter},
     .keys = {{{"2", ToolKind::sphere, "Sphere that pulls"}, {"4", ToolKind::point, "Point that pulls"}}}},
    {.action = ToolAction::smooth,
     .name = "smooth",
     .label = "Smooth",
     .help = "Evens out what strokes have done, as far as the radius reaches",
     .grips = false,
     .with_soft_tool = false,
     .inverse = ToolAction::smooth,
     .parameters = {radius_parameter, iterations_parameter},
     .keys = {{{"5", ToolKind::sphere, "Sphere that smooths"}}}},
});

constexpr const ToolActionRow& row_of(ToolAction action) {
  return tool_actions[static_cast<std::size_t>(action)];
}

constexpr const char* name_of(ToolKind kind) {
  return tool_kind_names[static_cast<std::size_t>(kind)];
}
constexpr const char* name_of(ToolAction action) {
  return row_of(action).name;
}

// What each row is called, in the order of the table.
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

// The parameter of an action that is this field of Tool; null where the action does not go by it.
constexpr const ToolParameter* parameter_of(ToolAction action, std::string_view field) {
  for (const ToolParameter& parameter : row_of(action).parameters) {
    if (parameter.field != nullptr && field == parameter.field) return &parameter;
  }
  return nullptr;
}

static_assert(
    [] {
      for (std::size_t a = 0; a < tool_actions.size(); ++a) {
        if (static_cast<std::size_t>(tool_actions[a].action) != a) return false;
      }
      return true;
    }(),
    "the rows are in the order of the enumeration");

}  // namespace spoonbill
