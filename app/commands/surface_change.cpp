#include "app/commands/surface_change.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <utility>

#include "app/commands/option_values.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/seam.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {
namespace {

constexpr int control_points_limit = 200;
constexpr Range<double> cap_height_range_m{0.0, 1.0};

struct Call {
  const Surface& surface;
  const std::vector<std::string>& values;  // the words after the change's name
  double tolerance_m;
};

struct Change {
  const char* name;
  std::size_t fewest_values, most_values;
  const char* form;
  const char* what;
  std::function<Result<ChangedSurfaces>(const Call&)> make;
  // Where the change does not keep the parameters, what becomes of a trim loop; empty where that is nothing.
  std::function<TrimLoop(const Call&, const TrimLoop&)> turn_trim = {};
};

Result<Direction> direction_of(const std::string& text) {
  if (text == "u") return Direction::u;
  if (text == "v") return Direction::v;
  return Error{quoted(text, 20) + " is not a direction; say u or v"};
}

Result<double> number_of(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    return Error{quoted(text, 20) + " is not a number"};
  }
  return number;
}

Result<int> whole_number_of(const std::string& text) {
  const auto number = number_of(text);
  if (!number) return number.error();
  if (number.value() != std::floor(number.value()) || std::abs(number.value()) > 1000.0) {
    return Error{quoted(text, 20) + " is not a whole number"};
  }
  return static_cast<int>(number.value());
}

// "v=0.3"
struct Place {
  Direction direction;
  double parameter;
};

Result<Place> place_of(const std::string& text) {
  const Error refusal{quoted(text, 40) + " is not a place like v=0.3, in the knots' domain"};
  if (text.size() < 3 || text[1] != '=') return refusal;
  const auto direction = direction_of(text.substr(0, 1));
  const auto parameter = number_of(text.substr(2));
  if (!direction || !parameter) return refusal;
  return Place{direction.value(), parameter.value()};
}

Result<ChangedSurfaces> exactly(Result<Surface> surface, bool keeps_parameters) {
  if (!surface) return surface.error();
  return ChangedSurfaces{{std::move(surface).value()}, {}, 0.0, keeps_parameters};
}

Result<ChangedSurfaces> nearly(Result<Approximation> result) {
  if (!result) return result.error();
  return ChangedSurfaces{{std::move(result->surface)}, {}, result->deviation_m, true};
}

Result<ChangedSurfaces> split(const Call& call) {
  const auto place = place_of(call.values[0]);
  if (!place) return place.error();
  const KnotVector& knots = knots_along(call.surface, place->direction);
  if (knots.is_periodic()) {
    // Around a seam there is one cut.
    return exactly(part_of(call.surface, place->direction, place->parameter,
                           place->parameter + knots.domain_end() - knots.domain_start()),
                   false);
  }
  auto first = part_of(call.surface, place->direction, knots.domain_start(), place->parameter);
  if (!first) return first.error();
  auto second = part_of(call.surface, place->direction, place->parameter, knots.domain_end());
  if (!second) return second.error();
  return ChangedSurfaces{{std::move(first).value(), std::move(second).value()}, {}, 0.0, false};
}

Result<ChangedSurfaces> insert(const Call& call) {
  const auto place = place_of(call.values[0]);
  if (!place) return place.error();
  const auto multiplicity = call.values.size() > 1 ? whole_number_of(call.values[1]) : Result(1);
  if (!multiplicity) return multiplicity.error();
  return exactly(insert_knot(call.surface, place->direction, place->parameter, multiplicity.value()), true);
}

Result<ChangedSurfaces> set_degree(const Call& call) {
  const auto direction = direction_of(call.values[0]);
  if (!direction) return direction.error();
  const auto degree = whole_number_of(call.values[1]);
  if (!degree) return degree.error();
  const KnotVector& knots = knots_along(call.surface, direction.value());
  if (degree.value() >= knots.degree()) {
    const auto higher = elevated(knots, degree.value());
    if (!higher) return higher.error();
    return exactly(over_finer_knots(call.surface, direction.value(), higher.value()), true);
  }
  const auto lower = reduced(knots, degree.value());
  if (!lower) return lower.error();
  return nearly(
      approximated(call.surface, direction.value(), lower.value(), call.tolerance_m, control_points_limit));
}

Result<ChangedSurfaces> simplify(const Call& call) {
  auto along_u = without_spare_knots(call.surface, Direction::u, 0.5 * call.tolerance_m);
  if (!along_u) return along_u.error();
  auto both = without_spare_knots(along_u->surface, Direction::v, 0.5 * call.tolerance_m);
  if (!both) return both.error();
  return ChangedSurfaces{{std::move(both->surface)}, {}, along_u->deviation_m + both->deviation_m, true};
}

Result<ChangedSurfaces> reverse(const Call& call) {
  const auto direction = direction_of(call.values[0]);
  if (!direction) return direction.error();
  return exactly(reversed(call.surface, direction.value()), false);
}

Result<ChangedSurfaces> exchange(const Call& call) {
  return exactly(exchanged(call.surface), false);
}

Result<ChangedSurfaces> move_seam(const Call& call) {
  const auto place = place_of(call.values[0]);
  if (!place) return place.error();
  return exactly(with_seam_at(call.surface, place->direction, place->parameter), false);
}

Result<ChangedSurfaces> close_around(const Call& call) {
  const auto direction = direction_of(call.values[0]);
  if (!direction) return direction.error();
  auto closed = closed_around(call.surface, direction.value(), 2, call.tolerance_m);
  if (!closed) return closed.error();
  return ChangedSurfaces{{std::move(closed->surface)}, {}, closed->deviation_m, true};
}

Result<ChangedSurfaces> cap(const Call& call) {
  const auto side = parse_side(call.values[0]);
  if (!side) return side.error();
  const auto height_m =
      call.values.size() > 1 ? parse_length(call.values[1], cap_height_range_m) : Result(0.0);
  if (!height_m) return height_m.error();
  JoinRequest request;
  request.tolerance_m = call.tolerance_m;
  auto capped = with_cap(call.surface, side.value(), height_m.value(), request);
  if (!capped) return capped.error();
  return ChangedSurfaces{{std::move(capped->surface)}, {}, capped->deviation_m, false};
}

Result<ChangedSurfaces> open_end(const Call& call) {
  const auto side = parse_side(call.values[0]);
  if (!side) return side.error();
  return exactly(opened_pole(call.surface, side.value(), HUGE_VAL), false);
}

// The words have been understood by then.
TrimLoop reverse_trim(const Call& call, const TrimLoop& loop) {
  const Direction direction = direction_of(call.values[0]).value();
  return reversed(loop, direction, knots_along(call.surface, direction));
}

TrimLoop exchange_trim(const Call&, const TrimLoop& loop) {
  return exchanged(loop);
}

TrimLoop move_trims_seam(const Call& call, const TrimLoop& loop) {
  const Place place = place_of(call.values[0]).value();
  return with_seam_at(loop, place.direction, knots_along(call.surface, place.direction), place.parameter);
}

Status turn_trims(const Change& change, const Call& call, const std::vector<TrimLoop>& trims,
                  ChangedSurfaces& changed) {
  if (trims.empty() || changed.keeps_parameters) {
    changed.trims = trims;
    return {};
  }
  if (!change.turn_trim) {
    return Error{std::string("'") + change.name +
                 "' would lose its trims; make it whole first, by `spoonbill merge` of it alone"};
  }
  for (const TrimLoop& loop : trims) changed.trims.push_back(change.turn_trim(call, loop));
  return {};
}

const std::vector<Change>& all_changes() {
  static const std::vector<Change> changes{
      {"split", 1, 1, "v=0.5", "cut in two there, or open around where it is closed", split},
      {"insert", 1, 2, "v=0.5 [2]", "a knot, so many times; exact", insert},
      {"degree", 2, 2, "v 5", "raise the degree (exact) or lower it within the tolerance", set_degree},
      {"simplify", 0, 0, "", "remove the knots that the tolerance can spare", simplify},
      {"reverse", 1, 1, "v", "run through a direction backwards; turns the normals", reverse, reverse_trim},
      {"exchange", 0, 0, "", "u becomes v and v becomes u; turns the normals", exchange, exchange_trim},
      {"seam", 1, 1, "u=0.25", "begin the closed direction there", move_seam, move_trims_seam},
      {"close", 1, 1, "u", "close around where the first and the last edge meet", close_around},
      {"cap", 1, 2, "v_end [3mm]", "close an open end of a tube, flat or bulging so far", cap},
      {"open", 1, 1, "v_end", "cut the pole off where the sides begin to run straight", open_end}};
  return changes;
}

}  // namespace

Result<ChangedSurfaces> changed(const Surface& surface, const std::vector<TrimLoop>& trims,
                                const std::vector<std::string>& words, double tolerance_m) {
  std::string known;
  for (const Change& change : all_changes()) {
    known += (known.empty() ? "" : ", ") + std::string(change.name);
    if (words.empty() || words[0] != change.name) continue;
    const std::vector<std::string> values(words.begin() + 1, words.end());
    if (values.size() < change.fewest_values || values.size() > change.most_values) {
      return Error{std::string("'") + change.name + "' is asked for as: " + change.name + " " + change.form};
    }
    const Call call{surface, values, tolerance_m};
    auto result = change.make(call);
    if (!result) return result;
    if (Status status = turn_trims(change, call, trims, result.value()); !status) return status.error();
    return result;
  }
  return Error{quoted(words.empty() ? "" : words[0], 20) + " is no change; choose from " + known};
}

std::string changes_text() {
  std::string text;
  for (const Change& change : all_changes()) {
    std::string left = std::string("  ") + change.name + " " + change.form;
    left.resize(std::max<std::size_t>(left.size() + 2, 24), ' ');
    text += left + change.what + "\n";
  }
  return text;
}

}  // namespace spoonbill
