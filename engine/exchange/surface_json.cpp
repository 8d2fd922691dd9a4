#include <utility>
#include <vector>

#include "engine/exchange/length.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {

namespace {

constexpr Range<double> knot_range{-1e6, 1e6};
// Knots nearer than this share of the domain are meant to be equal; apart they make derivatives overflow.
constexpr double smallest_knot_step = 1e-9;

std::vector<double> read_knots(FieldReader& reader, int most) {
  std::vector<double> knots;
  for (const Json& item : reader.list("knots", {3, most})) {
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
  const double smallest = smallest_knot_step * (direction.domain_end() - direction.domain_start());
  const std::vector<double>& knots = direction.knots();
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double step = knots[i] - knots[i - 1];
    if (step == 0.0 || step >= smallest) continue;
    reader.refuse("knots[" + std::to_string(i) + "]", "is nearly the knot before it, make the two equal");
  }
}

std::optional<ControlNet> read_net(FieldReader& reader, int row_count, int column_count) {
  const char* field = "control_points_mm";
  const Json& rows = reader.list(field, {row_count, row_count});
  if (!reader.status().ok()) return std::nullopt;
  ControlNet net(row_count, column_count);
  for (int i = 0; i < row_count; ++i) {
    const Json& row = rows[static_cast<std::size_t>(i)];
    const std::string row_name = field + ("[" + std::to_string(i) + "]");
    if (!row.is_array() || row.size() != static_cast<std::size_t>(column_count)) {
      reader.refuse(row_name, "is " + json_excerpt(row) + ", must be a list of " +
                                  std::to_string(column_count) + " points as the knots along v ask");
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

}  // namespace

std::optional<KnotVector> read_knot_vector(FieldReader& reader, Range<int> control_point_counts) {
  const int degree = reader.integer("degree", {1, max_degree});
  const bool periodic = reader.boolean("periodic");
  std::vector<double> knots = read_knots(reader, control_point_counts.high + max_degree + 1);
  if (!reader.status().ok()) return std::nullopt;

  auto direction =
      periodic ? KnotVector::periodic(degree, std::move(knots)) : KnotVector::open(degree, std::move(knots));
  if (!direction.ok()) {
    reader.refuse("knots", "do not fit: " + direction.error().message);
    return std::nullopt;
  }
  const int count = direction->control_point_count();
  if (!control_point_counts.contains(count)) {
    reader.refuse("knots", "ask for " + std::to_string(count) + " control points, at most " +
                               std::to_string(control_point_counts.high) + " are handled");
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
  reader.refuse(surface.error().message);
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

}  // namespace spoonbill
