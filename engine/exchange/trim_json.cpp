#include <utility>
#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

constexpr Range<double> parameter_range{-1e7, 1e7};

bool read_parameters(const Json& json, double& u, double& v) {
  if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number()) return false;
  u = json[0].get<double>();
  v = json[1].get<double>();
  return parameter_range.contains(u) && parameter_range.contains(v);
}

std::optional<TrimLoop> read_trim(FieldReader reader, const Surface& surface) {
  std::optional<KnotVector> knots = read_knot_vector(reader, trim_control_point_count_range);
  const char* field = "control_points_uv";
  const int count = knots ? knots->control_point_count() : 0;
  std::vector<double> u, v;
  for (const Json& item : reader.list(field, {count, count})) {
    if (read_parameters(item, u.emplace_back(), v.emplace_back())) continue;
    reader.refuse(field + ("[" + std::to_string(u.size() - 1) + "]"),
                  "must be 2 numbers from -10000000 to 10000000");
    break;
  }
  reader.finish();
  if (!knots || !reader.status().ok()) return std::nullopt;
  auto loop = make_trim_loop(surface.u, surface.v, *std::move(knots), std::move(u), std::move(v));
  if (loop.ok()) return std::move(loop).value();
  reader.refuse(loop.error().message);
  return std::nullopt;
}

}  // namespace

std::vector<TrimLoop> read_trims(FieldReader& surface_reader, const Surface& surface) {
  std::vector<TrimLoop> trims;
  if (!surface_reader.has("trims")) return trims;
  for (const Json& item : surface_reader.list("trims", trim_loop_count_range)) {
    std::optional<TrimLoop> loop = read_trim(surface_reader.element(item, "trims", trims.size()), surface);
    if (!loop) return {};
    trims.push_back(*std::move(loop));
  }
  const auto area = TrimmedArea::make(surface.u, surface.v, trims);
  if (!area.ok()) surface_reader.refuse("trims", "do not fit: " + area.error().message);
  return trims;
}

void add_trims(const std::vector<TrimLoop>& trims, Json& surface_json) {
  for (const TrimLoop& loop : trims) {
    Json& json = surface_json["trims"].emplace_back(Json::object());
    add_knot_vector(loop.knots, json);
    Json& points = json["control_points_uv"] = Json::array();
    for (std::size_t i = 0; i < loop.u.size(); ++i) {
      points.push_back(Json::array({number_to_json(loop.u[i]), number_to_json(loop.v[i])}));
    }
  }
}

}  // namespace spoonbill
