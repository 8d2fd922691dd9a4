#include "engine/exchange/document.h"

#include <utility>

#include "engine/base/file.h"
#include "engine/exchange/field_json.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/length.h"
#include "engine/exchange/region_json.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

constexpr std::size_t document_bytes_limit = std::size_t{64} << 20;
constexpr std::size_t material_bytes_limit = std::size_t{1} << 20;

// And supports; a body may have neither.
void read_loads(FieldReader& reader, Body& body) {
  const auto visit = [&](const char* field, const Range<int>& count, const auto& take) {
    reader.ignore(field);
    if (!reader.has(field)) return;
    std::size_t index = 0;
    for (const Json& item : reader.list(field, count)) {
      FieldReader item_reader = reader.element(item, field, index++);
      take(item_reader);
      item_reader.finish();
    }
  };
  visit("loads", load_count_range,
        [&](FieldReader& item) { body.loads.push_back(read_load(item, body.surface)); });
  visit("supports", support_count_range,
        [&](FieldReader& item) { body.supports.push_back(read_support(item)); });
}

// Version 1 had neither trims nor solids, so that they are unknown there.
std::optional<Body> read_body(FieldReader reader, int version) {
  std::string name = reader.text("name");
  FieldReader surface_reader = reader.inner("surface");
  std::optional<Surface> surface = read_surface(surface_reader);
  std::vector<TrimLoop> trims;
  if (surface && version > 1) trims = read_trims(surface_reader, *surface);
  surface_reader.finish();
  FieldReader material_reader = reader.inner("material");
  Material material = read_fields<Material>(material_reader);
  material_reader.finish();
  FieldReader lattice_reader = reader.inner("lattice");
  const LatticeRequest lattice = read_lattice_request(lattice_reader);
  lattice_reader.finish();
  if (!surface || !reader.status().ok()) return std::nullopt;
  Body body{std::move(name), *std::move(surface), std::move(material), lattice};
  read_loads(reader, body);
  if (reader.has("shell_thickness_mm")) {
    body.shell_thickness_m = reader.length_m("shell_thickness_mm", shell_thickness_range_m);
  }
  body.regions = read_material_regions(reader);
  body.trims = std::move(trims);
  if (version > 1 && reader.has("solid")) body.solid = reader.text("solid");
  reader.finish();
  if (!reader.status().ok()) return std::nullopt;
  return body;
}

// Those of a document with one body are in no list.
std::optional<std::vector<Body>> read_bodies(FieldReader& reader, int version) {
  std::vector<Body> bodies;
  const auto take = [&](std::optional<Body> body) {
    if (!body) return false;
    bodies.push_back(*std::move(body));
    return true;
  };
  if (!take(read_body(reader.inner("body"), version))) return std::nullopt;
  if (!reader.has("other_bodies")) {
    reader.ignore("other_bodies");
    return bodies;
  }
  const Range<int> others{0, body_count_range.high - 1};
  for (const Json& item : reader.list("other_bodies", others)) {
    FieldReader body_reader = reader.element(item, "other_bodies", bodies.size() - 1);
    if (!take(read_body(std::move(body_reader), version))) return std::nullopt;
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

Symmetry read_symmetry_of(FieldReader& reader) {
  if (!reader.has("symmetry")) return {};
  FieldReader symmetry_reader = reader.inner("symmetry");
  Symmetry symmetry = read_fields<Symmetry>(symmetry_reader);
  symmetry_reader.finish();
  return symmetry;
}

std::optional<Ground> read_ground_of(FieldReader& reader) {
  if (!reader.has("ground")) return std::nullopt;
  FieldReader ground_reader = reader.inner("ground");
  const Ground ground = read_fields<Ground>(ground_reader);
  ground_reader.finish();
  return ground;
}

// One that nobody has chosen is left out, so that documents without symmetry stay as they are.
bool is_chosen(const Symmetry& symmetry) {
  const Symmetry usual;
  return symmetry.on || symmetry.point_m != usual.point_m || symmetry.normal != usual.normal;
}

Json body_to_json(const Body& body) {
  Json json;
  json["name"] = body.name;
  json["surface"] = surface_to_json(body.surface);
  add_trims(body.trims, json["surface"]);
  add_fields(body.material, json["material"]);
  add_lattice_request(body.lattice, json["lattice"]);
  for (const Load& load : body.loads) json["loads"].push_back(load_to_json(load));
  for (const Support& support : body.supports) json["supports"].push_back(support_to_json(support));
  if (body.shell_thickness_m) json["shell_thickness_mm"] = length_to_json(*body.shell_thickness_m);
  add_material_regions(body.regions, json);
  if (!body.solid.empty()) json["solid"] = body.solid;
  return json;
}

Result<Json> read_json(const std::filesystem::path& file, std::size_t bytes_limit) {
  auto text = read_file(file, bytes_limit);
  if (!text.ok()) return text.error();
  return parse_json(text.value(), file.string());
}

}  // namespace

Result<Document> document_from_json(const Json& json, const std::string& source) {
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
  const Symmetry symmetry = read_symmetry_of(reader);
  const std::optional<Ground> ground = read_ground_of(reader);
  Json view = reader.has("view") ? reader.object("view") : Json::object();
  reader.ignore("view");
  reader.finish();
  if (!bodies || !reader.status().ok()) return reader.status().error();
  return Document{std::move(name),
                  Scene{*std::move(bodies), std::move(planes), tool, sculpting, symmetry, ground},
                  std::move(view)};
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
  if (is_chosen(document.scene.symmetry)) add_fields(document.scene.symmetry, json["symmetry"]);
  if (document.scene.ground) add_fields(*document.scene.ground, json["ground"]);
  json["view"] = document.view;
  return json;
}

Result<Document> read_document(const std::filesystem::path& file) {
  auto json = read_json(file, document_bytes_limit);
  if (!json.ok()) return json.error();
  return document_from_json(json.value(), file.string());
}

Status write_document(const Document& document, const std::filesystem::path& file) {
  const std::string page = json_to_page(document_to_json(document));
  if (page.size() > document_bytes_limit) {
    return Error{file.string() + ": not saved, larger than 64 MiB; leave bodies out"};
  }
  auto read_back = parse_json(page, file.string() + ": not saved");
  if (!read_back.ok()) return read_back.error();
  auto checked = document_from_json(read_back.value(), file.string() + ": not saved");
  if (!checked.ok()) return checked.error();
  return replace_file(file, page);
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
  return material_from_json(json.value(), file.string());
}

}  // namespace spoonbill
