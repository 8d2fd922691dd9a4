#include <algorithm>
#include <array>
#include <string_view>

#include "engine/exchange/document.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

constexpr std::array<std::string_view, 10> command_names = {
    "place_plane",  "remove_planes", "set_tool",  "set_material", "set_sculpting",
    "set_symmetry", "reset_proxy",   "lift_tool", "keep_shape",   "refine_knots"};

int read_body(FieldReader& reader) {
  return reader.has("body") ? reader.integer("body", {0, sculpted_body_count_range.high - 1}) : 0;
}

SetMaterial read_set_material(FieldReader& reader) {
  SetMaterial command{read_material_fields(reader)};
  command.body = read_body(reader);
  return command;
}

Command read_named(std::string_view name, FieldReader& reader) {
  if (name == "place_plane") return PlacePlane{read_fixing_plane(reader)};
  if (name == "remove_planes") return RemovePlanes{};
  if (name == "set_tool") return SetTool{read_tool(reader)};
  if (name == "set_material") return read_set_material(reader);
  if (name == "set_sculpting") return SetSculpting{read_sculpting(reader)};
  if (name == "set_symmetry") return SetSymmetry{read_symmetry(reader)};
  if (name == "reset_proxy") return ResetProxy{};
  if (name == "lift_tool") return LiftTool{};
  if (name == "keep_shape") return KeepShape{};
  if (name == "refine_knots") return RefineKnots{read_body(reader)};
  reader.refuse("command",
                "is " + json_excerpt(Json(name)) + ", must be one of " + simulation_command_names());
  return KeepShape{};
}

struct FieldsOf {
  Json operator()(const PlacePlane& command) const {
    Json json{{"command", "place_plane"}};
    add_fixing_plane(command.plane, json);
    return json;
  }
  Json operator()(const RemovePlanes&) const { return {{"command", "remove_planes"}}; }
  Json operator()(const SetTool& command) const {
    Json json{{"command", "set_tool"}};
    add_tool(command.tool, json);
    return json;
  }
  Json operator()(const SetMaterial& command) const {
    Json json{{"command", "set_material"}};
    add_material_fields(command.material, json);
    if (command.body != 0) json["body"] = command.body;
    return json;
  }
  Json operator()(const SetSculpting& command) const {
    Json json{{"command", "set_sculpting"}};
    add_sculpting(command.sculpting, json);
    return json;
  }
  Json operator()(const SetSymmetry& command) const {
    Json json{{"command", "set_symmetry"}};
    add_symmetry(command.symmetry, json);
    return json;
  }
  Json operator()(const ResetProxy&) const { return {{"command", "reset_proxy"}}; }
  Json operator()(const LiftTool&) const { return {{"command", "lift_tool"}}; }
  Json operator()(const KeepShape&) const { return {{"command", "keep_shape"}}; }
  Json operator()(const RefineKnots& command) const {
    Json json{{"command", "refine_knots"}};
    if (command.body != 0) json["body"] = command.body;
    return json;
  }
};

}  // namespace

bool is_simulation_command(const Json& json) {
  if (!json.is_object()) return false;
  const auto name = json.find("command");
  if (name == json.end() || !name->is_string()) return false;
  return std::find(command_names.begin(), command_names.end(), name->get_ref<const std::string&>()) !=
         command_names.end();
}

std::string simulation_command_names() {
  std::string names;
  for (const std::string_view name : command_names) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

Result<Command> command_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  const std::string name = reader.text("command");
  if (!reader.status().ok()) return reader.status().error();
  Command command = read_named(name, reader);
  reader.finish();
  if (!reader.status().ok()) return reader.status().error();
  return command;
}

Json command_to_json(const Command& command) {
  return std::visit(FieldsOf{}, command);
}

}  // namespace spoonbill
