#include "engine/exchange/scene_json.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "engine/base/text.h"
#include "engine/exchange/field_json.h"
#include "engine/exchange/surface_json.h"

namespace spoonbill {

namespace {

void read_counts(FieldReader& reader, LatticeRequest& lattice) {
  const Range<double> range{static_cast<double>(node_count_range.low),
                            static_cast<double>(node_count_range.high)};
  const Vector3 nodes = reader.vector("nodes", range);
  lattice.counts = {static_cast<int>(nodes.x()), static_cast<int>(nodes.y()), static_cast<int>(nodes.z())};
  if (nodes != Vector3((*lattice.counts)[0], (*lattice.counts)[1], (*lattice.counts)[2])) {
    reader.refuse("nodes", "must be whole numbers");
  }
  if (nodes.prod() > node_budget_range.high) {
    reader.refuse("nodes", "must have a product of at most " + std::to_string(node_budget_range.high),
                  ErrorCode::too_many);
  }
}

// Reads the triangles of a mesh. Returns nullopt if a list is malformed.
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
                  "must be 3 indices into vertices_mm, from 0");
    return std::nullopt;
  }
  return mesh;
}

}  // namespace

std::optional<CleanMesh> read_mesh(FieldReader& reader) {
  std::optional<TriangleMesh> mesh = read_triangles(reader);
  if (!mesh || !reader.status().ok()) return std::nullopt;
  Result<CleanMesh> clean = clean_mesh(*std::move(mesh), "mesh");
  if (clean.ok()) return std::move(clean).value();
  reader.refuse(clean.error());
  return std::nullopt;
}

void add_mesh(const TriangleMesh& mesh, Json& json) {
  Json& vertices = json["vertices_mm"] = Json::array();
  for (const Vector3& vertex : mesh.vertices_m) vertices.push_back(position_to_json(vertex));
  json["triangles"] = mesh.triangles;
}

namespace {

// Indices of "mesh" and "surface" in the list of shape names. These two shapes have no table of fields and
// follow the shapes that have one.
constexpr std::size_t mesh_index = kind_names<ImplicitShape>.size(), surface_index = mesh_index + 1;
constexpr auto shape_names = [] {
  std::array<const char*, surface_index + 1> names{};
  std::copy(kind_names<ImplicitShape>.begin(), kind_names<ImplicitShape>.end(), names.begin());
  names[mesh_index] = kind_name<MeshSolid>;
  names[surface_index] = kind_name<SurfaceSolid>;
  return names;
}();

std::optional<ToolSolid> read_solid(FieldReader reader) {
  const std::size_t index = reader.choose("shape", shape_names);
  std::optional<ToolSolid> solid;
  if (index == surface_index) {
    std::optional<Surface> surface = read_surface(reader);
    if (surface) solid = SurfaceSolid{*std::move(surface)};
  } else if (index == mesh_index) {
    if (std::optional<CleanMesh> mesh = read_mesh(reader)) solid = MeshSolid{*std::move(mesh)};
  } else {
    auto shape = make_kind<ImplicitShape>(index);
    std::visit([&](auto& kind) { read_fields(reader, kind); }, shape);
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
  if (const Status status = check_tool_body(*body); !status.ok()) reader.refuse(status.error());
  return body;
}

// Visitor that converts the solid of a tool to JSON.
struct ToolSolidToJson {
  Json operator()(const ImplicitShape& shape) const {
    const auto write = []<class Shape>(const Shape& kind) {
      Json json{{"shape", kind_name<Shape>}};
      add_fields(kind, json);
      return json;
    };
    return std::visit(write, shape);
  }
  Json operator()(const MeshSolid& solid) const {
    Json json{{"shape", kind_name<MeshSolid>}};
    add_mesh(solid.mesh.mesh, json);
    return json;
  }
  Json operator()(const SurfaceSolid& solid) const {
    Json json{{"shape", kind_name<SurfaceSolid>}};
    json.update(surface_to_json(solid.surface));
    return json;
  }
};

constexpr double depth_limit_m = 1.0;

Range<double> read_fractions(FieldReader& reader, const char* field) {
  const Json& list = reader.list(field, {2, 2});
  Range<double> fractions{0.0, 1.0};
  if (!reader.status().ok()) return fractions;
  for (const auto& [index, fraction] : {std::pair{0u, &fractions.low}, std::pair{1u, &fractions.high}}) {
    if (list[index].is_number()) *fraction = list[index].get<double>();
    const bool fits = list[index].is_number() && *fraction >= 0.0 && *fraction <= 1.0;
    if (!fits) reader.refuse(field, "is " + json_excerpt(list) + ", must be two numbers from 0 to 1");
  }
  return fractions;
}

// Reads one or two depths. A single depth is the smallest; the largest is then unlimited.
Range<double> read_depths(FieldReader& reader) {
  const Json& list = reader.list("depth_mm", {1, 2});
  Range<double> depths = BodyRegion().depth_m;
  if (!reader.status().ok()) return depths;
  bool fits = true;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::optional<double> depth = length_from_json(list[i]);
    fits &= depth && *depth >= 0.0 && *depth <= depth_limit_m;
    if (fits) (i == 0 ? depths.low : depths.high) = *depth;
  }
  if (!fits) {
    reader.refuse("depth_mm", "is " + json_excerpt(list) + ", must be one or two numbers from 0 to " +
                                  number_text(1e3 * depth_limit_m));
  }
  return depths;
}

void refuse_failure(const Status& status, FieldReader& reader) {
  if (!status.ok() && reader.status().ok()) reader.refuse(status.error());
}

MaterialRegion read_material_region(FieldReader reader) {
  MaterialRegion region;
  region.region = read_region(reader.inner("region"));
  if (reader.has("material")) {
    FieldReader material = reader.inner("material");
    region.material = read_fields<Material>(material);
    material.finish();
  }
  if (reader.has("friction")) region.friction = reader.number("friction", friction_range);
  for (const char* field : {"material", "friction"}) reader.ignore(field);
  reader.finish();
  if (!region.material && !region.friction) {
    reader.refuse("must have material or friction, or both", ErrorCode::missing);
  }
  return region;
}

}  // namespace

LatticeRequest read_lattice_request(FieldReader& reader) {
  LatticeRequest lattice;
  if (reader.has("nodes") == reader.has("node_budget")) {
    reader.refuse("must have either nodes or node_budget",
                  reader.has("nodes") ? ErrorCode::duplicate : ErrorCode::missing);
    return lattice;
  }
  if (reader.has("feature_map")) {
    FieldReader map = reader.inner("feature_map");
    lattice.feature_map = read_fields<FeatureMapSettings>(map);
    map.finish();
  }
  if (reader.has("cells")) {
    lattice.cells = static_cast<LatticeCells>(reader.choose("cells", lattice_cells_names));
  }
  if (reader.has("node_budget")) {
    lattice.node_budget = reader.integer("node_budget", node_budget_range);
  } else {
    read_counts(reader, lattice);
  }
  return lattice;
}

void add_lattice_request(const LatticeRequest& lattice, Json& json) {
  if (lattice.counts) {
    json["nodes"] = *lattice.counts;
  } else {
    json["node_budget"] = lattice.node_budget;
  }
  if (lattice.feature_map) add_fields(*lattice.feature_map, json["feature_map"]);
  if (lattice.cells != LatticeCells::bent) {
    json["cells"] = lattice_cells_names[static_cast<std::size_t>(lattice.cells)];
  }
}

Tool read_tool(FieldReader& reader) {
  Tool tool = read_fields<Tool>(reader);
  if (tool.kind == ToolKind::solid || reader.has("solid")) tool.body = read_tool_body(reader);
  return tool;
}

void add_tool(const Tool& tool, Json& json) {
  add_fields(tool, json);
  if (!tool.body) return;
  json["solid"] = std::visit(ToolSolidToJson{}, tool.body->solid);
  if (!tool.body->soft) return;
  const SoftTool& soft = *tool.body->soft;
  add_fields(soft.material, json["soft"]["material"]);
  add_lattice_request(soft.lattice, json["soft"]["lattice"]);
  add_fields(soft.grip, json["soft"]["grip"]);
}

BodyRegion read_region(FieldReader reader) {
  BodyRegion region;
  if (reader.has("along")) region.along = read_fractions(reader, "along");
  if (reader.has("around")) region.around = read_fractions(reader, "around");
  if (reader.has("depth_mm")) region.depth_m = read_depths(reader);
  refuse_failure(check_region(region), reader);
  for (const char* field : {"along", "around", "depth_mm"}) reader.ignore(field);
  reader.finish();
  return region;
}

Json region_to_json(const BodyRegion& region) {
  const BodyRegion whole;
  Json json = Json::object();
  const auto add = [&](const char* field, const Range<double>& range, const Range<double>& all) {
    if (range.low == all.low && range.high == all.high) return;
    json[field] = Json::array({number_to_json(range.low), number_to_json(range.high)});
  };
  add("along", region.along, whole.along);
  add("around", region.around, whole.around);
  if (region.depth_m.high != whole.depth_m.high) {
    json["depth_mm"] = Json::array({length_to_json(region.depth_m.low), length_to_json(region.depth_m.high)});
  } else if (region.depth_m.low != whole.depth_m.low) {
    json["depth_mm"] = Json::array({length_to_json(region.depth_m.low)});
  }
  return json;
}

Load read_load(FieldReader& reader, const Surface& surface) {
  Load load = make_kind<Load>(reader.choose("kind", kind_names<Load>));
  const auto read = [&]<class Kind>(Kind& kind) {
    if constexpr (std::is_same_v<Kind, PointLoad>) {
      reader.number("u", {surface.u.domain_start(), surface.u.domain_end()});
      reader.number("v", {surface.v.domain_start(), surface.v.domain_end()});
    } else {
      kind.region = read_region(reader.inner("region"));
    }
    read_fields(reader, kind);
  };
  std::visit(read, load);
  return load;
}

Json load_to_json(const Load& load) {
  const auto write = []<class Kind>(const Kind& kind) {
    Json json{{"kind", kind_name<Kind>}};
    if constexpr (!std::is_same_v<Kind, PointLoad>) json["region"] = region_to_json(kind.region);
    add_fields(kind, json);
    return json;
  };
  return std::visit(write, load);
}

Support read_support(FieldReader& reader) {
  Support support{read_region(reader.inner("region"))};
  if (reader.has("motion")) {
    FieldReader motion = reader.inner("motion");
    support.motion = read_fields<SupportMotion>(motion);
    motion.finish();
  }
  reader.ignore("motion");
  refuse_failure(check_support(support), reader);
  return support;
}

Json support_to_json(const Support& support) {
  Json json;
  json["region"] = region_to_json(support.region);
  if (support.motion) add_fields(*support.motion, json["motion"]);
  return json;
}

std::vector<MaterialRegion> read_material_regions(FieldReader& body) {
  std::vector<MaterialRegion> regions;
  if (!body.has("regions")) {
    body.ignore("regions");
    return regions;
  }
  for (const Json& item : body.list("regions", material_region_count_range)) {
    regions.push_back(read_material_region(body.element(item, "regions", regions.size())));
  }
  return regions;
}

void add_material_regions(const std::vector<MaterialRegion>& regions, Json& body) {
  for (const MaterialRegion& region : regions) {
    Json& json = body["regions"].emplace_back(Json::object());
    json["region"] = region_to_json(region.region);
    if (region.material) add_fields(*region.material, json["material"]);
    if (region.friction) json["friction"] = number_to_json(*region.friction);
  }
}

}  // namespace spoonbill
