// Documents: a scene and how it is looked at, as JSON that a person can read (lengths in mm, said in each
// name).
#pragma once

#include <filesystem>
#include <string>

#include "engine/exchange/json.h"
#include "engine/result.h"
#include "engine/simulation/command.h"
#include "engine/simulation/scene.h"

namespace spoonbill {

inline constexpr int document_version = 1;

// What is saved. `view` belongs to the program that draws (camera, overlays) and is kept as it was read.
struct Document {
  std::string name;
  Scene scene;
  Json view = Json::object();
};

// `source` names the file in messages. Unknown fields are refused by name, so that a misspelt one is not
// silently ignored; numbers must be finite and within the ranges that the message states.
Result<Document> document_from_json(const Json& json, const std::string& source);

// Every number reads back to the same bits; what was read and not changed is written as the same bytes again.
Json document_to_json(const Document& document);

// At most 64 MiB is read.
Result<Document> read_document(const std::filesystem::path& file);

// Written beside the file, flushed and renamed, so that a crash leaves the old or the new document whole; the
// old one stays as FILE.bak. Refused before anything is touched: a document that could not be read back.
Status write_document(const Document& document, const std::filesystem::path& file);

// A material by itself, as assets/materials holds them.
Result<Material> material_from_json(const Json& json, const std::string& source);
Json material_to_json(const Material& material);
Result<Material> read_material(const std::filesystem::path& file);

// One form a command, every field required (those of tool, material and sculpting are the document's):
//   {"command": "place_plane", "point_mm": [x, y, z], "normal": [x, y, z]}      {"command": "remove_planes"}
//   {"command": "set_tool", "kind", "action", "radius_mm", "iterations"}         {"command": "keep_shape"}
//   {"command": "set_material", "name", "source", "youngs_modulus_pa", ...}
//   {"command": "set_sculpting", "damping_per_s", "gravity_m_per_s2", "force_scale"}
Result<Command> command_from_json(const Json& json, const std::string& source);
Json command_to_json(const Command& command);

// Whether "command" names one of the above; recordings also hold commands that belong to the view.
bool is_simulation_command(const Json& json);

}  // namespace spoonbill
