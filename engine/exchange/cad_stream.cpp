#include "engine/exchange/cad_stream.h"

#include <utility>

#include "engine/exchange/cad_names.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {
Json cad_surface_to_json(const CadSurface& surface) {
  Json json;
  json["name"] = surface.name;
  json["surface"] = surface_to_json(surface.surface);
  add_trims(surface.trims, json["surface"]);
  json["deviation_m"] = surface.deviation_m;
  json["trim_problem"] = clean_cad_name(surface.trim_problem, "");
  json["solid"] = clean_cad_name(surface.solid, "");
  return json;
}

Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source) {
  const auto json = parse_json(text, source);
  if (!json) return json.error();
  FieldReader named(json.value(), source);
  CadSurface result;
  result.name = named.text("name");
  if (!named.status().ok()) return named.status().error();

  FieldReader reader(json.value(), source + ": '" + result.name + "'");
  reader.ignore("name");
  FieldReader surface_reader = reader.inner("surface");
  std::optional<Surface> surface = read_surface(surface_reader);
  if (surface) result.trims = read_trims(surface_reader, *surface);
  surface_reader.finish();
  result.deviation_m = reader.number("deviation_m", {0.0, 1e3});
  result.trim_problem = reader.text("trim_problem");
  result.solid = reader.text("solid");
  reader.finish();
  if (!surface || !reader.status().ok()) return reader.status().error();
  result.surface = *std::move(surface);
  return result;
}

}  // namespace spoonbill
