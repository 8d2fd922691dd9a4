#include <algorithm>
#include <string_view>
#include <variant>

#include "engine/exchange/document.h"
#include "engine/exchange/field_json.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

constexpr const auto& command_names = kind_names<Command>;

auto find_command(std::string_view name) {
  return std::find(command_names.begin(), command_names.end(), name);
}

int read_body(FieldReader& reader) {
  return reader.has("body") ? reader.integer("body", {0, sculpted_body_count_range.high - 1}) : 0;
}

void add_body(int body, Json& json) {
  if (body != 0) json["body"] = body;
}

// What a command says besides its name.
template <class Wordless>
void read_content(FieldReader&, Wordless&) {}
void read_content(FieldReader& reader, PlacePlane& command) {
  read_fields(reader, command.plane);
}
void read_content(FieldReader& reader, SetTool& command) {
  command.tool = read_tool(reader);
}
void read_content(FieldReader& reader, SetMaterial& command) {
  read_fields(reader, command.material);
  command.body = read_body(reader);
}
void read_content(FieldReader& reader, SetSculpting& command) {
  read_fields(reader, command.sculpting);
}
void read_content(FieldReader& reader, SetSymmetry& command) {
  read_fields(reader, command.symmetry);
}
void read_content(FieldReader& reader, RefineKnots& command) {
  command.body = read_body(reader);
}

template <class Wordless>
void add_content(const Wordless&, Json&) {}
void add_content(const PlacePlane& command, Json& json) {
  add_fields(command.plane, json);
}
void add_content(const SetTool& command, Json& json) {
  add_tool(command.tool, json);
}
void add_content(const SetMaterial& command, Json& json) {
  add_fields(command.material, json);
  add_body(command.body, json);
}
void add_content(const SetSculpting& command, Json& json) {
  add_fields(command.sculpting, json);
}
void add_content(const SetSymmetry& command, Json& json) {
  add_fields(command.symmetry, json);
}
void add_content(const RefineKnots& command, Json& json) {
  add_body(command.body, json);
}

}  // namespace

bool is_simulation_command(const Json& json) {
  if (!json.is_object()) return false;
  const auto name = json.find("command");
  if (name == json.end() || !name->is_string()) return false;
  return find_command(name->get_ref<const std::string&>()) != command_names.end();
}

std::string simulation_command_names() {
  std::string names;
  for (const char* name : command_names) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

Result<Command> command_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  const std::string name = reader.text("command");
  if (!reader.status().ok()) return reader.status().error();
  const auto known = find_command(name);
  if (known == command_names.end()) {
    reader.refuse("command",
                  "is " + json_excerpt(Json(name)) + ", must be one of " + simulation_command_names());
    return reader.status().error();
  }
  auto command = make_kind<Command>(static_cast<std::size_t>(known - command_names.begin()));
  std::visit([&](auto& of) { read_content(reader, of); }, command);
  reader.finish();
  if (!reader.status().ok()) return reader.status().error();
  return command;
}

Json command_to_json(const Command& command) {
  const auto write = []<class Kind>(const Kind& of) {
    Json json{{"command", kind_name<Kind>}};
    add_content(of, json);
    return json;
  };
  return std::visit(write, command);
}

}  // namespace spoonbill
