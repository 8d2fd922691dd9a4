#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "engine/exchange/field_json.h"
#include "engine/exchange/length.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

// Nothing where a list is not what it must be.
std::optional<TriangleMesh> read_triangles(FieldReader& reader) {
  TriangleMesh mesh;
  const Range<int> counts{3, 3 * tool_triangle_limit};
  for (const Json& item : reader.list("vertices_mm", counts)) {
    Vector3& vertex = mesh.vertices_m.emplace_back();
    if (read_point(item, vertex)) continue;
    reader.refuse("vertices_mm[" + std::to_string(mesh.vertices_m.size() - 1) + "]",
                  "must be 3 numbers from -100000 to 100000");
    return std::nullopt;
  }
  for (const Json& item : reader.list("triangles", {1, tool_triangle_limit})) {
    TriangleCorners& corners = mesh.triangles.emplace_back();
    bool whole = item.is_array() && item.size() == 3;
    for (std::size_t c = 0; whole && c < 3; ++c) {
      whole = item[c].is_number_unsigned() && item[c].get<std::uint64_t>() < mesh.vertices_m.size();
      if (whole) corners[c] = item[c].get<std::uint32_t>();
    }
    if (whole) continue;
    reader.refuse("triangles[" + std::to_string(mesh.triangles.size() - 1) + "]",
                  "must be 3 places in vertices_mm, from 0");
    return std::nullopt;
  }
  return mesh;
}

std::optional<ToolSolid> read_mesh(FieldReader& reader) {
  std::optional<TriangleMesh> mesh = read_triangles(reader);
  if (!mesh || !reader.status().ok()) return std::nullopt;
  Result<CleanMesh> clean = clean_mesh(*std::move(mesh), "mesh");
  if (clean.ok()) return MeshSolid{std::move(clean).value()};
  reader.refuse(clean.error().message);
  return std::nullopt;
}

// The shapes that have a table of fields, then those that do not.
constexpr std::size_t mesh_place = kind_names<ImplicitShape>.size(), surface_place = mesh_place + 1;
constexpr auto shape_names = [] {
  std::array<const char*, surface_place + 1> names{};
  std::copy(kind_names<ImplicitShape>.begin(), kind_names<ImplicitShape>.end(), names.begin());
  names[mesh_place] = kind_name<MeshSolid>;
  names[surface_place] = kind_name<SurfaceSolid>;
  return names;
}();

std::optional<ToolSolid> read_solid(FieldReader reader) {
  const std::size_t place = reader.choose("shape", shape_names);
  std::optional<ToolSolid> solid;
  if (place == surface_place) {
    std::optional<Surface> surface = read_surface(reader);
    if (surface) solid = SurfaceSolid{*std::move(surface)};
  } else if (place == mesh_place) {
    solid = read_mesh(reader);
  } else {
    auto shape = make_kind<ImplicitShape>(place);
    std::visit([&](auto& of) { read_fields(reader, of); }, shape);
    solid = shape;
  }
  reader.finish();
  return solid;
}

SoftTool read_soft(FieldReader reader) {
  SoftTool soft;
  FieldReader material = reader.inner("material");
  soft.material = read_fields<Material>(material);
  material.finish();
  FieldReader lattice = reader.inner("lattice");
  soft.lattice = read_lattice_request(lattice);
  lattice.finish();
  FieldReader grip = reader.inner("grip");
  soft.grip = read_fields<FixingPlane>(grip);
  grip.finish();
  reader.finish();
  return soft;
}

std::shared_ptr<const ToolBody> read_tool_body(FieldReader& reader) {
  std::optional<ToolSolid> solid = read_solid(reader.inner("solid"));
  std::optional<SoftTool> soft;
  if (reader.has("soft")) soft = read_soft(reader.inner("soft"));
  if (!solid || !reader.status().ok()) return nullptr;
  auto body = std::make_shared<ToolBody>(ToolBody{*std::move(solid), std::move(soft)});
  if (const Status status = check_tool_body(*body); !status.ok()) reader.refuse(status.error().message);
  return body;
}

struct FieldsOfSolid {
  Json operator()(const ImplicitShape& shape) const {
    const auto write = []<class Shape>(const Shape& of) {
      Json json{{"shape", kind_name<Shape>}};
      add_fields(of, json);
      return json;
    };
    return std::visit(write, shape);
  }
  Json operator()(const MeshSolid& solid) const {
    Json json{{"shape", kind_name<MeshSolid>}};
    Json& vertices = json["vertices_mm"] = Json::array();
    for (const Vector3& vertex : solid.mesh.mesh.vertices_m) vertices.push_back(position_to_json(vertex));
    json["triangles"] = solid.mesh.mesh.triangles;
    return json;
  }
  Json operator()(const SurfaceSolid& solid) const {
    Json json{{"shape", kind_name<SurfaceSolid>}};
    json.update(surface_to_json(solid.surface));
    return json;
  }
};

}  // namespace

Tool read_tool(FieldReader& reader) {
  Tool tool = read_fields<Tool>(reader);
  if (tool.kind == ToolKind::solid || reader.has("solid")) tool.body = read_tool_body(reader);
  return tool;
}

void add_tool(const Tool& tool, Json& json) {
  add_fields(tool, json);
  if (!tool.body) return;
  json["solid"] = std::visit(FieldsOfSolid{}, tool.body->solid);
  if (!tool.body->soft) return;
  const SoftTool& soft = *tool.body->soft;
  add_fields(soft.material, json["soft"]["material"]);
  add_lattice_request(soft.lattice, json["soft"]["lattice"]);
  add_fields(soft.grip, json["soft"]["grip"]);
}

}  // namespace spoonbill
