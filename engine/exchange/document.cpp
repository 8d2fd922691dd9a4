#include "engine/exchange/document.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/file.h"
#include "engine/exchange/field_json.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/old_documents.h"
#include "engine/exchange/scene_json.h"
#include "engine/exchange/surface_json.h"
#include "engine/scene/place_body.h"

namespace spoonbill {

namespace {

constexpr std::size_t document_bytes_limit = std::size_t{128} << 20;
constexpr std::size_t material_bytes_limit = std::size_t{1} << 20;

constexpr const char* explain_mesh = "must be missing, because the body has a mesh";

// Reads the optional lists of loads and supports of a body.
void read_loads_and_supports(FieldReader& reader, Body& body) {
  const auto read_list = [&](const char* field, const Range<int>& count, const auto& read_item) {
    reader.ignore(field);
    if (!reader.has(field)) return;
    if (body.mesh) {
      reader.refuse(field, explain_mesh, ErrorCode::inconsistent);
      return;
    }
    std::size_t index = 0;
    for (const Json& item : reader.list(field, count)) {
      FieldReader item_reader = reader.element(item, field, index++);
      read_item(item_reader);
      item_reader.finish();
    }
  };
  read_list("loads", load_count_range,
            [&](FieldReader& item) { body.loads.push_back(read_load(item, body.surface)); });
  read_list("supports", support_count_range,
            [&](FieldReader& item) { body.supports.push_back(read_support(item)); });
}

void read_rim(FieldReader& reader, Body& body) {
  reader.ignore("rim_uv");
  if (!reader.has("rim_uv")) return;
  if (body.mesh) {
    reader.refuse("rim_uv", explain_mesh, ErrorCode::inconsistent);
    return;
  }
  for (const Json& item : reader.list("rim_uv", rim_corner_count_range)) {
    Vector2& corner = body.rim.emplace_back(Vector2::Zero());
    const bool is_point = read_parameters(item, corner.x(), corner.y());
    const KnotVector &u = body.surface.u, &v = body.surface.v;
    if (is_point && Range<double>{u.domain_start(), u.domain_end()}.contains(corner.x()) &&
        Range<double>{v.domain_start(), v.domain_end()}.contains(corner.y())) {
      continue;
    }
    reader.refuse("rim_uv[" + std::to_string(body.rim.size() - 1) + "]",
                  "must be 2 numbers, the parameters u and v of a point of the surface");
    return;
  }
}

BodyMotion read_motion(FieldReader& reader) {
  BodyMotion motion;
  if (reader.has("point_mm")) motion.point_m = reader.position_m("point_mm", position_range_m);
  std::size_t index = 0;
  for (const Json& item : reader.list("waypoints", waypoint_count_range)) {
    FieldReader waypoint_reader = reader.element(item, "waypoints", index++);
    motion.waypoints.push_back(read_fields<Waypoint>(waypoint_reader));
    waypoint_reader.finish();
  }
  if (!reader.status().ok()) return motion;
  if (const Status status = check_motion(motion); !status.ok()) reader.refuse(status.error());
  return motion;
}

void add_motion(const BodyMotion& motion, Json& json) {
  json["point_mm"] = position_to_json(motion.point_m);
  for (const Waypoint& waypoint : motion.waypoints) {
    Json item = Json::object();
    add_fields(waypoint, item);
    json["waypoints"].push_back(std::move(item));
  }
}

// Says why a body's kind does not permit a field, for a message after the field's name.
std::string explain_kind(const std::string& field) {
  if (field == "hand") return "must be missing, because the body is not rigid; or make it rigid";
  if (field == "motion") {
    return "must be missing, because the body is neither fixed nor held by a hand; or make it fixed";
  }
  if (field == "mesh") {
    return "must be missing, because the body is deformable; or make it fixed or rigid, or fit a surface to "
           "it";
  }
  if (field == "shell_thickness_mm" || field == "rim_uv") return explain_mesh;
  return "must be missing, because the body is not deformable; or make it deformable";
}

BodyKind read_kind(FieldReader& reader) {
  if (!reader.has("kind")) return BodyKind::deformable;
  return static_cast<BodyKind>(reader.choose("kind", body_kind_names));
}

// Surface of a body, or the mesh that bounds it instead.
struct ReadShape {
  Surface surface = {};
  std::vector<TrimLoop> trims = {};
  std::shared_ptr<const CleanMesh> mesh = {};
};

std::optional<ReadShape> read_body_mesh(FieldReader& reader) {
  if (reader.has("surface")) {
    reader.refuse("mesh", "must be missing, because the body has a surface", ErrorCode::inconsistent);
    return std::nullopt;
  }
  FieldReader mesh_reader = reader.inner("mesh");
  std::optional<CleanMesh> mesh = read_mesh(mesh_reader);
  mesh_reader.finish();
  if (!mesh) return std::nullopt;
  if (const Status status = check_mesh(*mesh); !status.ok()) reader.refuse(status.error());
  return ReadShape{{}, {}, std::make_shared<const CleanMesh>(*std::move(mesh))};
}

std::optional<ReadShape> read_body_shape(FieldReader& reader, int version) {
  if (reader.has("mesh")) return read_body_mesh(reader);
  FieldReader surface_reader = reader.inner("surface");
  std::optional<Surface> surface = read_surface(surface_reader);
  std::vector<TrimLoop> trims;
  if (surface && version > 1) trims = read_trims(surface_reader, *surface);
  surface_reader.finish();
  if (!surface) return std::nullopt;
  return ReadShape{*std::move(surface), std::move(trims)};
}

// Reads a body. The fields "trims" and "solid" are unknown in version 1.
std::optional<Body> read_body(FieldReader reader, int version) {
  std::string name = reader.text("name");
  std::optional<ReadShape> shape = read_body_shape(reader, version);
  FieldReader material_reader = reader.inner("material");
  Material material = read_fields<Material>(material_reader);
  material_reader.finish();
  const BodyKind kind = read_kind(reader);
  LatticeRequest lattice;
  if (kind == BodyKind::deformable || reader.has("lattice")) {
    FieldReader lattice_reader = reader.inner("lattice");
    lattice = read_lattice_request(lattice_reader);
    lattice_reader.finish();
  }
  if (!shape || !reader.status().ok()) return std::nullopt;
  Body body{std::move(name), std::move(shape->surface), std::move(material), lattice};
  body.mesh = std::move(shape->mesh);
  body.kind = kind;
  if (reader.has("hand")) {
    FieldReader hand_reader = reader.inner("hand");
    body.hand = read_fields<HandSpring>(hand_reader);
    hand_reader.finish();
  }
  if (reader.has("motion")) {
    FieldReader motion_reader = reader.inner("motion");
    body.motion = read_motion(motion_reader);
    motion_reader.finish();
  }
  read_loads_and_supports(reader, body);
  if (reader.has("shell_thickness_mm")) {
    body.shell_thickness_m = reader.length_m("shell_thickness_mm", shell_thickness_range_m);
  }
  body.regions = read_material_regions(reader);
  body.trims = std::move(shape->trims);
  read_rim(reader, body);
  if (version > 1 && reader.has("solid")) body.solid = reader.text("solid");
  if (const Status status = check_kind(body); !status.ok()) {
    reader.refuse(status.error().field, explain_kind(status.error().field), status.error().code);
  }
  if (reader.has("pose")) {
    FieldReader pose_reader = reader.inner("pose");
    const BodyPlacement placement = read_fields<BodyPlacement>(pose_reader);
    pose_reader.finish();
    if (reader.status().ok()) move_body(placement.pose(), body);
  }
  reader.finish();
  if (!reader.status().ok()) return std::nullopt;
  return body;
}

// Refuses more control points than document_control_point_limit.
void check_control_point_count(const std::vector<Body>& bodies, FieldReader& reader) {
  std::size_t count = 0;
  for (const Body& body : bodies) count += body.surface.net.size();
  if (count <= static_cast<std::size_t>(document_control_point_limit)) return;
  reader.refuse("other_bodies",
                "have " + std::to_string(count) + " control points with the first body; at most " +
                    std::to_string(document_control_point_limit) + " are allowed; use fewer bodies",
                ErrorCode::too_many);
}

// Reads the field "body" and the optional field "other_bodies".
std::optional<std::vector<Body>> read_bodies(FieldReader& reader, int version) {
  std::vector<Body> bodies;
  const auto append = [&](std::optional<Body> body) {
    if (!body) return false;
    bodies.push_back(*std::move(body));
    return true;
  };
  if (!append(read_body(reader.inner("body"), version))) return std::nullopt;
  if (!reader.has("other_bodies")) {
    reader.ignore("other_bodies");
    return bodies;
  }
  const Range<int> others{0, body_count_range.high - 1};
  for (const Json& item : reader.list("other_bodies", others)) {
    FieldReader body_reader = reader.element(item, "other_bodies", bodies.size() - 1);
    if (!append(read_body(std::move(body_reader), version))) return std::nullopt;
  }
  return bodies;
}

std::vector<FixingPlane> read_planes(FieldReader& reader) {
  std::vector<FixingPlane> planes;
  if (!reader.has("fixing_planes")) {
    reader.ignore("fixing_planes");
    return planes;
  }
  for (const Json& item : reader.list("fixing_planes", fixing_plane_count_range)) {
    FieldReader plane_reader = reader.element(item, "fixing_planes", planes.size());
    planes.push_back(read_fields<FixingPlane>(plane_reader));
    plane_reader.finish();
  }
  return planes;
}

Symmetry read_symmetry(FieldReader& reader) {
  if (!reader.has("symmetry")) return {};
  FieldReader symmetry_reader = reader.inner("symmetry");
  Symmetry symmetry = read_fields<Symmetry>(symmetry_reader);
  symmetry_reader.finish();
  return symmetry;
}

std::optional<Ground> read_ground(FieldReader& reader) {
  if (!reader.has("ground")) return std::nullopt;
  FieldReader ground_reader = reader.inner("ground");
  const Ground ground = read_fields<Ground>(ground_reader);
  ground_reader.finish();
  return ground;
}

std::optional<TrialPlan> read_trial(FieldReader& reader) {
  if (!reader.has("trial")) return std::nullopt;
  FieldReader trial_reader = reader.inner("trial");
  TrialPlan plan = read_fields<TrialPlan>(trial_reader);
  trial_reader.finish();
  return plan;
}

// Returns true if the symmetry differs from the default. A default symmetry is not written.
bool is_not_default(const Symmetry& symmetry) {
  const Symmetry standard;
  return symmetry.on || symmetry.point_m != standard.point_m || symmetry.normal != standard.normal;
}

Json body_to_json(const Body& body) {
  Json json;
  json["name"] = body.name;
  if (body.kind != BodyKind::deformable) json["kind"] = body_kind_names[static_cast<std::size_t>(body.kind)];
  if (body.mesh) {
    add_mesh(find_placed_mesh(body), json["mesh"]);
  } else {
    json["surface"] = surface_to_json(body.surface);
    add_trims(body.trims, json["surface"]);
  }
  add_fields(body.material, json["material"]);
  if (body.hand) {
    json["hand"] = Json::object();  // the fields with default values are not written
    add_fields(*body.hand, json["hand"]);
  }
  if (body.motion) add_motion(*body.motion, json["motion"]);
  if (body.kind == BodyKind::deformable) add_lattice_request(body.lattice, json["lattice"]);
  for (const Load& load : body.loads) json["loads"].push_back(load_to_json(load));
  for (const Support& support : body.supports) json["supports"].push_back(support_to_json(support));
  if (body.shell_thickness_m) json["shell_thickness_mm"] = length_to_json(*body.shell_thickness_m);
  add_material_regions(body.regions, json);
  for (const Vector2& corner : body.rim) {
    json["rim_uv"].push_back(Json::array({number_to_json(corner.x()), number_to_json(corner.y())}));
  }
  if (!body.solid.empty()) json["solid"] = body.solid;
  return json;
}

Result<Json> read_json(const std::filesystem::path& file, std::size_t bytes_limit) {
  auto text = read_file(file, bytes_limit);
  if (!text.ok()) return text.error();
  return parse_json(text.value(), file.string());
}

constexpr const auto& command_names = kind_names<Command>;

auto find_command(std::string_view name) {
  return std::find(command_names.begin(), command_names.end(), name);
}

// Reads the optional index of the body to which a command applies.
int read_body_index(FieldReader& reader) {
  return reader.has("body") ? reader.integer("body", {0, sculpted_body_count_range.high - 1}) : 0;
}

void add_body_index(int body, Json& json) {
  if (body != 0) json["body"] = body;
}

// Reads an optional range of a surface's parameter, [low, high].
std::optional<Range<double>> read_parameter_range(FieldReader& reader, const char* field) {
  if (!reader.has(field)) return std::nullopt;
  const Json& ends = reader.list(field, {2, 2});
  if (!reader.status().ok()) return std::nullopt;
  if (!ends[0].is_number() || !ends[1].is_number() || !(ends[0].get<double>() <= ends[1].get<double>())) {
    reader.refuse(field, "must be two numbers, [low, high]");
    return std::nullopt;
  }
  return Range<double>{ends[0].get<double>(), ends[1].get<double>()};
}

// Reads the fields of a command other than its name.
template <class CommandWithoutFields>
void read_content(FieldReader&, CommandWithoutFields&) {}
void read_content(FieldReader& reader, PlacePlane& command) {
  read_fields(reader, command.plane);
}
void read_content(FieldReader& reader, SetTool& command) {
  command.tool = read_tool(reader);
}
void read_content(FieldReader& reader, SetMaterial& command) {
  read_fields(reader, command.material);
  command.body = read_body_index(reader);
}
void read_content(FieldReader& reader, SetSculpting& command) {
  read_fields(reader, command.sculpting);
}
void read_content(FieldReader& reader, SetSymmetry& command) {
  read_fields(reader, command.symmetry);
}
void read_content(FieldReader& reader, RefineKnots& command) {
  command.body = read_body_index(reader);
  command.u = read_parameter_range(reader, "u");
  command.v = read_parameter_range(reader, "v");
}
void read_content(FieldReader& reader, TurnBody& command) {
  read_fields(reader, command);
  command.body = read_body_index(reader);
}
void read_content(FieldReader& reader, LowerBody& command) {
  read_fields(reader, command);
  command.body = read_body_index(reader);
}

void read_content(FieldReader& reader, MoveBody& command) {
  command.motion = read_motion(reader);
  command.body = read_body_index(reader);
}

template <class CommandWithoutFields>
void add_content(const CommandWithoutFields&, Json&) {}
void add_content(const PlacePlane& command, Json& json) {
  add_fields(command.plane, json);
}
void add_content(const SetTool& command, Json& json) {
  add_tool(command.tool, json);
}
void add_content(const SetMaterial& command, Json& json) {
  add_fields(command.material, json);
  add_body_index(command.body, json);
}
void add_content(const SetSculpting& command, Json& json) {
  add_fields(command.sculpting, json);
}
void add_content(const SetSymmetry& command, Json& json) {
  add_fields(command.symmetry, json);
}
void add_content(const RefineKnots& command, Json& json) {
  add_body_index(command.body, json);
  if (command.u) json["u"] = {command.u->low, command.u->high};
  if (command.v) json["v"] = {command.v->low, command.v->high};
}
void add_content(const TurnBody& command, Json& json) {
  add_fields(command, json);
  add_body_index(command.body, json);
}
void add_content(const LowerBody& command, Json& json) {
  add_fields(command, json);
  add_body_index(command.body, json);
}
void add_content(const MoveBody& command, Json& json) {
  add_motion(command.motion, json);
  add_body_index(command.body, json);
}

// Reads a document of any version, after its fields have been converted to the current ones.
Result<Document> read_current_fields(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  const int version = reader.version("spoonbill_document", {oldest_document_version, document_version});
  std::string name = reader.text("name");
  std::optional<std::vector<Body>> bodies = read_bodies(reader, version);
  std::vector<FixingPlane> planes = read_planes(reader);
  FieldReader tool_reader = reader.inner("tool");
  const Tool tool = read_tool(tool_reader);
  tool_reader.finish();
  FieldReader sculpting_reader = reader.inner("sculpting");
  const Sculpting sculpting = read_fields<Sculpting>(sculpting_reader);
  sculpting_reader.finish();
  const Symmetry symmetry = read_symmetry(reader);
  const std::optional<Ground> ground = read_ground(reader);
  std::optional<TrialPlan> trial = read_trial(reader);
  Json view = reader.has("view") ? reader.object("view") : Json::object();
  reader.ignore("view");
  reader.finish();
  if (bodies) check_control_point_count(*bodies, reader);
  if (!bodies || !reader.status().ok()) return reader.status().error();
  Scene scene{*std::move(bodies), std::move(planes), tool, sculpting, symmetry, ground, std::move(trial)};
  if (const Status status = check_trial(scene); !status.ok()) return status.error().in(source);
  return Document{std::move(name), std::move(scene), std::move(view)};
}

}  // namespace

Result<Document> document_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  reader.version("spoonbill_document", {oldest_document_version, document_version});
  if (!reader.status().ok()) return reader.status().error();
  if (!is_old_document(json)) return read_current_fields(json, source);
  const auto converted = convert_old_document(json, source);
  if (!converted.ok()) return converted.error();
  return read_current_fields(converted.value(), source);
}

Json document_to_json(const Document& document) {
  Json json;
  json["spoonbill_document"] = document_version;
  json["name"] = document.name;
  const std::vector<Body>& bodies = document.scene.bodies;
  json["body"] = body_to_json(bodies.front());
  for (std::size_t other = 1; other < bodies.size(); ++other) {
    json["other_bodies"].push_back(body_to_json(bodies[other]));
  }
  Json& planes = json["fixing_planes"] = Json::array();
  for (const FixingPlane& plane : document.scene.planes) add_fields(plane, planes.emplace_back());
  add_tool(document.scene.tool, json["tool"]);
  add_fields(document.scene.sculpting, json["sculpting"]);
  if (is_not_default(document.scene.symmetry)) add_fields(document.scene.symmetry, json["symmetry"]);
  if (document.scene.ground) add_fields(*document.scene.ground, json["ground"]);
  if (document.scene.trial) add_fields(*document.scene.trial, json["trial"] = Json::object());
  json["view"] = document.view;
  return json;
}

Result<Document> read_document(const std::filesystem::path& file) {
  auto json = read_json(file, document_bytes_limit);
  if (!json.ok()) return json.error();
  return document_from_json(json.value(), file.string());
}

Status write_document(const Document& document, const std::filesystem::path& file,
                      const OutputOptions& options) {
  const std::string page = json_to_page(document_to_json(document));
  if (page.size() > document_bytes_limit) {
    return Error{ErrorCode::too_many, file.string() + ": not saved, larger than 128 MiB; remove bodies"};
  }
  auto read_back = parse_json(page, file.string() + ": not saved");
  if (!read_back.ok()) return read_back.error();
  auto checked = document_from_json(read_back.value(), file.string() + ": not saved");
  if (!checked.ok()) return checked.error();
  // A pipe or device that a person named is written to directly; a file must not replace it.
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const bool is_special = std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
  if (is_special && options.named_by == NamedBy::person) {
    return write_file(file, page, Durability::now, options);
  }
  return replace_file(file, page, options);
}

Result<Material> material_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  Material material = read_fields<Material>(reader);
  reader.finish();
  if (!reader.status().ok()) return reader.status().error();
  return material;
}

Json material_to_json(const Material& material) {
  Json json;
  add_fields(material, json);
  return json;
}

Result<Material> read_material(const std::filesystem::path& file) {
  auto json = read_json(file, material_bytes_limit);
  if (!json.ok()) return json.error();
  const Status converted = convert_old_material(json.value(), file.string());
  if (!converted.ok()) return converted.error();
  return material_from_json(json.value(), file.string());
}

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
                  "is " + json_excerpt(Json(name)) + ", must be one of " + simulation_command_names(),
                  ErrorCode::unknown);
    return reader.status().error();
  }
  auto command = make_kind<Command>(static_cast<std::size_t>(known - command_names.begin()));
  std::visit([&](auto& kind) { read_content(reader, kind); }, command);
  reader.finish();
  if (!reader.status().ok()) return reader.status().error();
  return command;
}

Json command_to_json(const Command& command) {
  const auto write = []<class Kind>(const Kind& kind) {
    Json json{{"command", kind_name<Kind>}};
    add_content(kind, json);
    return json;
  };
  return std::visit(write, command);
}

}  // namespace spoonbill
