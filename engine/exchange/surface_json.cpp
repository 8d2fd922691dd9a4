#include "engine/exchange/surface_json.h"

#include <string>
#include <utility>

#include "engine/bspline/trimmed_area.h"
#include "engine/scene/scene.h"

namespace spoonbill {

namespace {

constexpr Range<double> knot_range{-1e6, 1e6};
// Smallest distance between unequal knots, as a fraction of the domain; smaller distances make derivatives
// overflow.
constexpr double smallest_knot_step = 1e-9;
constexpr Range<double> parameter_range{-1e7, 1e7};

std::vector<double> read_knots(FieldReader& reader, int largest_count) {
  std::vector<double> knots;
  for (const Json& item : reader.list("knots", {3, largest_count})) {
    const double knot = item.is_number() ? item.get<double>() : knot_range.high + 1.0;
    if (!knot_range.contains(knot)) {
      reader.refuse("knots[" + std::to_string(knots.size()) + "]",
                    "is " + json_excerpt(item) + ", must be a number from -1000000 to 1000000");
      return {};
    }
    knots.push_back(knot);
  }
  return knots;
}

void check_knot_steps(const KnotVector& direction, FieldReader& reader) {
  const double smallest = smallest_knot_step * direction.domain_length();
  const std::vector<double>& knots = direction.knots();
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double step = knots[i] - knots[i - 1];
    if (step == 0.0 || step >= smallest) continue;
    reader.refuse("knots[" + std::to_string(i) + "]",
                  "is nearly equal to the knot before it; make the two equal", ErrorCode::degenerate);
  }
}

std::optional<ControlNet> read_net(FieldReader& reader, int row_count, int column_count) {
  const char* field = "control_points_mm";
  if (row_count * column_count > document_control_point_limit) {
    reader.refuse(field,
                  "are " + std::to_string(row_count) + " x " + std::to_string(column_count) + "; at most " +
                      std::to_string(document_control_point_limit) + " are allowed",
                  ErrorCode::too_many);
    return std::nullopt;
  }
  const Json& rows = reader.list(field, {row_count, row_count});
  if (!reader.status().ok()) return std::nullopt;
  ControlNet net(row_count, column_count);
  for (int i = 0; i < row_count; ++i) {
    const Json& row = rows[static_cast<std::size_t>(i)];
    const std::string row_name = field + ("[" + std::to_string(i) + "]");
    if (!row.is_array() || row.size() != static_cast<std::size_t>(column_count)) {
      reader.refuse(row_name,
                    "is " + json_excerpt(row) + ", must be a list of " + std::to_string(column_count) +
                        " points to match the knots along v",
                    ErrorCode::inconsistent);
      return std::nullopt;
    }
    for (int j = 0; j < column_count; ++j) {
      Vector3 point;
      if (!read_point(row[static_cast<std::size_t>(j)], point)) {
        reader.refuse(row_name + "[" + std::to_string(j) + "]", "must be 3 numbers from -100000 to 100000");
        return std::nullopt;
      }
      net.set_point(i, j, point);
    }
  }
  return net;
}

std::optional<KnotVector> read_direction(FieldReader reader) {
  auto direction = read_knot_vector(reader, control_point_count_range);
  reader.finish();
  if (!reader.status().ok()) return std::nullopt;
  return direction;
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
  reader.refuse(loop.error());
  return std::nullopt;
}

}  // namespace

std::optional<KnotVector> read_knot_vector(FieldReader& reader, Range<int> control_point_counts) {
  const int degree = reader.integer("degree", {1, max_degree});
  const bool periodic = reader.boolean("periodic");
  std::vector<double> knots = read_knots(reader, control_point_counts.high + max_degree + 1);
  if (!reader.status().ok()) return std::nullopt;

  auto direction =
      periodic ? KnotVector::periodic(degree, std::move(knots)) : KnotVector::open(degree, std::move(knots));
  if (!direction.ok()) {
    reader.refuse("knots", "are invalid: " + direction.error().message, direction.error().code);
    return std::nullopt;
  }
  const int count = direction->control_point_count();
  if (!control_point_counts.contains(count)) {
    reader.refuse("knots",
                  "need " + std::to_string(count) + " control points, the limit is " +
                      std::to_string(control_point_counts.high),
                  ErrorCode::too_many);
  }
  check_knot_steps(direction.value(), reader);
  if (!reader.status().ok()) return std::nullopt;
  return std::move(direction).value();
}

void add_knot_vector(const KnotVector& knots, Json& json) {
  json["degree"] = knots.degree();
  json["periodic"] = knots.is_periodic();
  Json& list = json["knots"] = Json::array();
  for (const double knot : knots.knots()) list.push_back(number_to_json(knot));
}

bool read_point(const Json& json, Vector3& point_m) {
  if (!json.is_array() || json.size() != 3) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> length = length_from_json(json[axis]);
    if (!length || !position_range_m.contains(*length)) return false;
    point_m[static_cast<Eigen::Index>(axis)] = *length;
  }
  return true;
}

std::optional<Surface> read_surface(FieldReader& reader) {
  std::optional<KnotVector> u = read_direction(reader.inner("u"));
  std::optional<KnotVector> v = read_direction(reader.inner("v"));
  if (!u || !v) return std::nullopt;
  std::optional<ControlNet> net = read_net(reader, u->control_point_count(), v->control_point_count());
  if (!net) return std::nullopt;
  auto surface = make_surface(*std::move(u), *std::move(v), *std::move(net));
  if (surface.ok()) return std::move(surface).value();
  reader.refuse(surface.error());
  return std::nullopt;
}

Json surface_to_json(const Surface& surface) {
  Json json;
  add_knot_vector(surface.u, json["u"]);
  add_knot_vector(surface.v, json["v"]);
  Json& rows = json["control_points_mm"] = Json::array();
  for (int i = 0; i < surface.net.rows; ++i) {
    Json row = Json::array();
    for (int j = 0; j < surface.net.columns; ++j) row.push_back(position_to_json(surface.net.point(i, j)));
    rows.push_back(std::move(row));
  }
  return json;
}

std::vector<TrimLoop> read_trims(FieldReader& surface_reader, const Surface& surface) {
  std::vector<TrimLoop> trims;
  if (!surface_reader.has("trims")) return trims;
  for (const Json& item : surface_reader.list("trims", trim_loop_count_range)) {
    std::optional<TrimLoop> loop = read_trim(surface_reader.element(item, "trims", trims.size()), surface);
    if (!loop) return {};
    trims.push_back(*std::move(loop));
  }
  const auto area = TrimmedArea::make(surface.u, surface.v, trims);
  if (!area.ok()) surface_reader.refuse("trims", "are invalid: " + area.error().message, area.error().code);
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

bool read_parameters(const Json& json, double& u, double& v) {
  if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number()) return false;
  u = json[0].get<double>();
  v = json[1].get<double>();
  return parameter_range.contains(u) && parameter_range.contains(v);
}

Json position_to_json(const Vector3& position_m) {
  return Json::array(
      {length_to_json(position_m.x()), length_to_json(position_m.y()), length_to_json(position_m.z())});
}

}  // namespace spoonbill
