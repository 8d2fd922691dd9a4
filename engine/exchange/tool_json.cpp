#include <array>
#include <utility>

#include "engine/exchange/length.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

enum class Form {
  sphere,
  ellipsoid,
  cylinder,
  capsule,
  box,
  cone,
  torus,
  half_space,
  superquadric,
  mesh,
  surface
};

Vector3 lengths_m(FieldReader& reader, const char* field) {
  return reader.position_m(field, shape_length_m);
}

ImplicitShape read_implicit(Form form, FieldReader& reader) {
  const auto length = [&](const char* field) { return reader.length_m(field, shape_length_m); };
  const auto length_or_none = [&](const char* field) {
    return reader.length_m(field, shape_length_or_none_m);
  };
  switch (form) {
    case Form::ellipsoid:
      return EllipsoidShape{lengths_m(reader, "semi_axes_mm")};
    case Form::cylinder:
      return CylinderShape{length("radius_mm"), length("half_length_mm")};
    case Form::capsule:
      return CapsuleShape{length("radius_mm"), length_or_none("half_length_mm")};
    case Form::box:
      return BoxShape{lengths_m(reader, "half_extents_mm")};
    case Form::cone:
      return ConeShape{length("base_radius_mm"), length("height_mm")};
    case Form::torus:
      return TorusShape{length("ring_radius_mm"), length("tube_radius_mm")};
    case Form::half_space:
      return HalfSpaceShape{};
    case Form::superquadric:
      return SuperquadricShape{lengths_m(reader, "semi_axes_mm"),
                               reader.number("exponent_along", superquadric_exponent),
                               reader.number("exponent_around", superquadric_exponent)};
    default:
      return SphereShape{length_or_none("radius_mm")};
  }
}

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

std::optional<ToolSolid> read_solid(FieldReader reader) {
  const Form form = reader.choice<Form>("shape", {{"sphere", Form::sphere},
                                                  {"ellipsoid", Form::ellipsoid},
                                                  {"cylinder", Form::cylinder},
                                                  {"capsule", Form::capsule},
                                                  {"box", Form::box},
                                                  {"cone", Form::cone},
                                                  {"torus", Form::torus},
                                                  {"half_space", Form::half_space},
                                                  {"superquadric", Form::superquadric},
                                                  {"mesh", Form::mesh},
                                                  {"surface", Form::surface}});
  std::optional<ToolSolid> solid;
  if (form == Form::surface) {
    std::optional<Surface> surface = read_surface(reader);
    if (surface) solid = SurfaceSolid{*std::move(surface)};
  } else if (form == Form::mesh) {
    solid = read_mesh(reader);
  } else {
    solid = read_implicit(form, reader);
  }
  reader.finish();
  return solid;
}

SoftTool read_soft(FieldReader reader) {
  SoftTool soft;
  FieldReader material = reader.inner("material");
  soft.material = read_material_fields(material);
  material.finish();
  FieldReader lattice = reader.inner("lattice");
  soft.lattice = read_lattice_request(lattice);
  lattice.finish();
  FieldReader grip = reader.inner("grip");
  soft.grip = read_fixing_plane(grip);
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

struct FieldsOfShape {
  Json operator()(const SphereShape& shape) const {
    return {{"shape", "sphere"}, {"radius_mm", length_to_json(shape.radius_m)}};
  }
  Json operator()(const EllipsoidShape& shape) const {
    return {{"shape", "ellipsoid"}, {"semi_axes_mm", position_to_json(shape.semi_axes_m)}};
  }
  Json operator()(const CylinderShape& shape) const {
    return {{"shape", "cylinder"},
            {"radius_mm", length_to_json(shape.radius_m)},
            {"half_length_mm", length_to_json(shape.half_length_m)}};
  }
  Json operator()(const CapsuleShape& shape) const {
    return {{"shape", "capsule"},
            {"radius_mm", length_to_json(shape.radius_m)},
            {"half_length_mm", length_to_json(shape.half_length_m)}};
  }
  Json operator()(const BoxShape& shape) const {
    return {{"shape", "box"}, {"half_extents_mm", position_to_json(shape.half_extents_m)}};
  }
  Json operator()(const ConeShape& shape) const {
    return {{"shape", "cone"},
            {"base_radius_mm", length_to_json(shape.base_radius_m)},
            {"height_mm", length_to_json(shape.height_m)}};
  }
  Json operator()(const TorusShape& shape) const {
    return {{"shape", "torus"},
            {"ring_radius_mm", length_to_json(shape.ring_radius_m)},
            {"tube_radius_mm", length_to_json(shape.tube_radius_m)}};
  }
  Json operator()(const HalfSpaceShape&) const { return {{"shape", "half_space"}}; }
  Json operator()(const SuperquadricShape& shape) const {
    return {{"shape", "superquadric"},
            {"semi_axes_mm", position_to_json(shape.semi_axes_m)},
            {"exponent_along", number_to_json(shape.exponent_along)},
            {"exponent_around", number_to_json(shape.exponent_around)}};
  }
};

struct FieldsOfSolid {
  Json operator()(const ImplicitShape& shape) const { return std::visit(FieldsOfShape{}, shape); }
  Json operator()(const MeshSolid& solid) const {
    Json json{{"shape", "mesh"}};
    Json& vertices = json["vertices_mm"] = Json::array();
    for (const Vector3& vertex : solid.mesh.mesh.vertices_m) vertices.push_back(position_to_json(vertex));
    json["triangles"] = solid.mesh.mesh.triangles;
    return json;
  }
  Json operator()(const SurfaceSolid& solid) const {
    Json json{{"shape", "surface"}};
    json.update(surface_to_json(solid.surface));
    return json;
  }
};

}  // namespace

Tool read_tool(FieldReader& reader) {
  Tool tool;
  tool.kind = reader.choice<ToolKind>(
      "kind", {{"point", ToolKind::point}, {"sphere", ToolKind::sphere}, {"solid", ToolKind::solid}});
  tool.action = reader.choice<ToolAction>(
      "action", {{"push", ToolAction::push}, {"pull", ToolAction::pull}, {"smooth", ToolAction::smooth}});
  tool.radius_m = reader.length_m("radius_mm", tool_radius_range_m);
  tool.iterations = reader.integer("iterations", tool_iterations_range);
  if (tool.kind == ToolKind::solid || reader.has("solid")) tool.body = read_tool_body(reader);
  return tool;
}

void add_tool(const Tool& tool, Json& json) {
  json["kind"] = name_of(tool.kind);
  json["action"] = name_of(tool.action);
  json["radius_mm"] = length_to_json(tool.radius_m);
  json["iterations"] = tool.iterations;
  if (!tool.body) return;
  json["solid"] = std::visit(FieldsOfSolid{}, tool.body->solid);
  if (!tool.body->soft) return;
  const SoftTool& soft = *tool.body->soft;
  add_material_fields(soft.material, json["soft"]["material"]);
  add_lattice_request(soft.lattice, json["soft"]["lattice"]);
  add_fixing_plane(soft.grip, json["soft"]["grip"]);
}

}  // namespace spoonbill
