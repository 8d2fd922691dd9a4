#include "engine/exchange/cad_stream.h"

#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "engine/exchange/surface_json.h"

namespace spoonbill {
namespace {

constexpr std::size_t vertex_bytes = 3 * sizeof(double), triangle_bytes = sizeof(TriangleCorners);
constexpr int count_limit = 100'000'000;
constexpr Range<int> count_range{1, count_limit};
constexpr Range<double> length_range_m{0.0, 1e3};
constexpr Range<double> measure_range{0.0, 1e12};
constexpr Range<double> coordinate_range_m{-1e6, 1e6};

struct Counts {
  std::size_t vertices = 0, triangles = 0;
};

// Reads the JSON line of a solid.
void read_head(FieldReader& reader, std::size_t surfaces, CadSolid& solid, Counts& counts) {
  solid.name = clean_cad_name(reader.text("name"), "solid");
  solid.surface_indices = read_surface_indices(reader, "places", surfaces);
  if (solid.surface_indices.empty())
    reader.refuse("places", "is empty, must name a surface", ErrorCode::too_few);
  solid.chord_error_m = reader.number("chord_error_m", length_range_m);
  solid.gap_m = reader.number("gap_m", length_range_m);
  solid.volume_m3 = reader.number("volume_m3", measure_range);
  solid.area_m2 = reader.number("area_m2", measure_range);
  solid.centre_m = reader.vector("middle_m", coordinate_range_m);
  counts.vertices = static_cast<std::size_t>(reader.integer("vertices", count_range));
  counts.triangles = static_cast<std::size_t>(reader.integer("triangles", count_range));
  reader.finish();
}

// Reads vertices and triangles. Returns false if the size, a coordinate or an index is wrong.
bool read_mesh(std::string_view bytes, const Counts& counts, TriangleMesh& mesh) {
  const std::size_t points = counts.vertices * vertex_bytes;
  if (bytes.size() != points + counts.triangles * triangle_bytes) return false;
  mesh.vertices_m.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  for (std::size_t k = 0; k < counts.vertices; ++k) {
    std::memcpy(mesh.vertices_m[k].data(), bytes.data() + k * vertex_bytes, vertex_bytes);
  }
  std::memcpy(mesh.triangles.data(), bytes.data() + points, bytes.size() - points);
  for (const Vector3& vertex : mesh.vertices_m) {
    if (!vertex.allFinite() || vertex.cwiseAbs().maxCoeff() > coordinate_range_m.high) return false;
  }
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= counts.vertices) return false;
    }
  }
  return true;
}

}  // namespace

Json cad_surface_to_json(const CadSurface& surface) {
  Json json;
  json["name"] = surface.name;
  json["surface"] = surface_to_json(surface.surface);
  add_trims(surface.trims, json["surface"]);
  json["deviation_m"] = surface.deviation_m;
  json["trim_deviation_m"] = surface.trim_deviation_m;
  json["trim_problem"] = clean_cad_name(surface.trim_problem, "");
  json["solid"] = clean_cad_name(surface.solid, "");
  return json;
}

Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source) {
  const auto json = parse_json(text, source);
  if (!json) return json.error();
  FieldReader name_reader(json.value(), source);
  CadSurface result;
  result.name = name_reader.text("name");
  if (!name_reader.status().ok()) return name_reader.status().error();

  FieldReader reader(json.value(), source + ": '" + result.name + "'");
  reader.ignore("name");
  FieldReader surface_reader = reader.inner("surface");
  std::optional<Surface> surface = read_surface(surface_reader);
  if (surface) result.trims = read_trims(surface_reader, *surface);
  surface_reader.finish();
  result.deviation_m = reader.number("deviation_m", {0.0, 1e3});
  result.trim_deviation_m = reader.number("trim_deviation_m", {0.0, 1e6});
  result.trim_problem = reader.text("trim_problem");
  result.solid = reader.text("solid");
  reader.finish();
  if (!surface || !reader.status().ok()) return reader.status().error();
  result.surface = *std::move(surface);
  return result;
}

std::string cad_solid_to_bytes(const CadSolid& solid) {
  const Json head = {{"name", clean_cad_name(solid.name, "solid")},
                     {"places", solid.surface_indices},
                     {"chord_error_m", solid.chord_error_m},
                     {"gap_m", solid.gap_m},
                     {"volume_m3", solid.volume_m3},
                     {"area_m2", solid.area_m2},
                     {"middle_m", {solid.centre_m.x(), solid.centre_m.y(), solid.centre_m.z()}},
                     {"vertices", solid.mesh.vertices_m.size()},
                     {"triangles", solid.mesh.triangles.size()}};
  std::string bytes = json_to_line(head) + '\n';
  static_assert(sizeof(Vector3) == vertex_bytes);
  bytes.append(reinterpret_cast<const char*>(solid.mesh.vertices_m.data()),
               solid.mesh.vertices_m.size() * vertex_bytes);
  bytes.append(reinterpret_cast<const char*>(solid.mesh.triangles.data()),
               solid.mesh.triangles.size() * triangle_bytes);
  return bytes;
}

Result<CadSolid> cad_solid_from_bytes(std::string_view bytes, std::size_t surfaces,
                                      const std::string& source) {
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos)
    return Error{ErrorCode::malformed, source + ": the header line of a solid is missing or cut off"};
  const auto json = parse_json(bytes.substr(0, line), source);
  if (!json) return json.error();
  FieldReader reader(json.value(), source);
  CadSolid solid;
  Counts counts;
  read_head(reader, surfaces, solid, counts);
  if (!reader.status().ok()) return reader.status().error();
  if (!read_mesh(bytes.substr(line + 1), counts, solid.mesh)) {
    return Error{ErrorCode::malformed,
                 source + ": '" + solid.name + "': the mesh does not match the header line"};
  }
  return solid;
}

std::vector<std::size_t> read_surface_indices(FieldReader& reader, std::string_view field,
                                              std::size_t surfaces) {
  std::vector<std::size_t> indices;
  for (const Json& index : reader.list(field, {0, static_cast<int>(surfaces)})) {
    if (!index.is_number_unsigned() || index.get<std::size_t>() >= surfaces) {
      reader.refuse(field, "names a surface that does not exist");
      return {};
    }
    indices.push_back(index.get<std::size_t>());
  }
  return indices;
}

}  // namespace spoonbill
