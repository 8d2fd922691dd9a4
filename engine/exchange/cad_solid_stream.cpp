#include "engine/exchange/cad_solid_stream.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/exchange/cad_names.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"

namespace spoonbill {
namespace {

constexpr std::size_t bytes_of_vertex = 3 * sizeof(double), bytes_of_triangle = sizeof(TriangleCorners);
constexpr int most = 100'000'000;
constexpr Range<int> count_range{1, most};
constexpr Range<double> length_range_m{0.0, 1e3};
constexpr Range<double> measure_range{0.0, 1e12};
constexpr Range<double> coordinate_range_m{-1e6, 1e6};

struct Counts {
  std::size_t vertices = 0, triangles = 0;
};

void read_numbers(FieldReader& reader, std::size_t surfaces, CadSolid& solid, Counts& counts) {
  solid.name = clean_cad_name(reader.text("name"), "solid");
  solid.places = read_places(reader, "places", surfaces);
  if (solid.places.empty()) reader.refuse("places", "names no surface");
  solid.chord_error_m = reader.number("chord_error_m", length_range_m);
  solid.gap_m = reader.number("gap_m", length_range_m);
  solid.volume_m3 = reader.number("volume_m3", measure_range);
  solid.area_m2 = reader.number("area_m2", measure_range);
  solid.centre_m = reader.vector("middle_m", coordinate_range_m);
  counts.vertices = static_cast<std::size_t>(reader.integer("vertices", count_range));
  counts.triangles = static_cast<std::size_t>(reader.integer("triangles", count_range));
  reader.finish();
}

bool read_mesh(std::string_view bytes, const Counts& counts, TriangleMesh& mesh) {
  const std::size_t points = counts.vertices * bytes_of_vertex;
  if (bytes.size() != points + counts.triangles * bytes_of_triangle) return false;
  mesh.vertices_m.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  for (std::size_t k = 0; k < counts.vertices; ++k) {
    std::memcpy(mesh.vertices_m[k].data(), bytes.data() + k * bytes_of_vertex, bytes_of_vertex);
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

std::string cad_solid_to_bytes(const CadSolid& solid) {
  const Json head = {{"name", clean_cad_name(solid.name, "solid")},
                     {"places", solid.places},
                     {"chord_error_m", solid.chord_error_m},
                     {"gap_m", solid.gap_m},
                     {"volume_m3", solid.volume_m3},
                     {"area_m2", solid.area_m2},
                     {"middle_m", {solid.centre_m.x(), solid.centre_m.y(), solid.centre_m.z()}},
                     {"vertices", solid.mesh.vertices_m.size()},
                     {"triangles", solid.mesh.triangles.size()}};
  std::string bytes = json_to_line(head) + '\n';
  static_assert(sizeof(Vector3) == bytes_of_vertex);
  bytes.append(reinterpret_cast<const char*>(solid.mesh.vertices_m.data()),
               solid.mesh.vertices_m.size() * bytes_of_vertex);
  bytes.append(reinterpret_cast<const char*>(solid.mesh.triangles.data()),
               solid.mesh.triangles.size() * bytes_of_triangle);
  return bytes;
}

std::vector<std::size_t> read_places(FieldReader& reader, std::string_view field, std::size_t surfaces) {
  std::vector<std::size_t> places;
  for (const Json& place : reader.list(field, {0, static_cast<int>(surfaces)})) {
    if (!place.is_number_unsigned() || place.get<std::size_t>() >= surfaces) {
      reader.refuse(field, "names a surface that there is not");
      return {};
    }
    places.push_back(place.get<std::size_t>());
  }
  return places;
}

Result<CadSolid> cad_solid_from_bytes(std::string_view bytes, std::size_t surfaces,
                                      const std::string& source) {
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos) return Error{source + ": the solid has no head"};
  const auto json = parse_json(bytes.substr(0, line), source);
  if (!json) return json.error();
  FieldReader reader(json.value(), source);
  CadSolid solid;
  Counts counts;
  read_numbers(reader, surfaces, solid, counts);
  if (!reader.status().ok()) return reader.status().error();
  if (!read_mesh(bytes.substr(line + 1), counts, solid.mesh)) {
    return Error{source + ": '" + solid.name + "': the mesh is not what its head says"};
  }
  return solid;
}

}  // namespace spoonbill
