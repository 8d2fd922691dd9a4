#include "app/commands/surface_change.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "app/commands/option_values.h"
#include "app/commands/placing.h"
#include "engine/base/text.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/surface_check.h"
#include "engine/merging/tube_ends.h"
#include "engine/scene/body.h"

namespace spoonbill {
namespace {

constexpr int control_points_limit = control_point_count_range.high;
constexpr Range<double> cap_height_range_m{0.0, 1.0};

// Tolerance of a change that is not exact, and the observer that can stop the change.
struct Allowed {
  double tolerance_m;
  Progress progress;
};

// Parsers of the arguments of a change, one per argument, in order.
using WordParsers = std::vector<Status (*)(const std::string& word, ChangeRequest& request)>;

struct Change {
  ChangeKind kind;
  WordParsers words;
  std::size_t fewest_words;
  Result<ChangedSurfaces> (*make)(const Surface& surface, const ChangeRequest& request,
                                  const Allowed& allowed);
  // Maps a trim loop to the parameters of the changed surface. Null if the change keeps the parameters, so
  // that no mapping is needed, or if the change cannot map trims.
  TrimLoop (*map_trim)(const Surface& surface, const ChangeRequest& request, const TrimLoop& loop);
  const char *name, *form, *description;
};

template <class Number>
std::optional<Number> parse_whole_text(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

Status parse_direction_word(const std::string& word, ChangeRequest& request) {
  if (word != "u" && word != "v") {
    return Error{ErrorCode::unknown, "'" + excerpt(word) + "' is not a direction; choose u or v"};
  }
  request.direction = word == "u" ? Direction::u : Direction::v;
  return {};
}

// Parses a direction and a parameter, such as "v=0.3".
Status parse_parameter_word(const std::string& word, ChangeRequest& request) {
  const auto parameter = word.size() > 2 && word[1] == '='
                             ? parse_whole_text<double>(std::string_view(word).substr(2))
                             : std::nullopt;
  if (!parameter || !std::isfinite(*parameter) || !parse_direction_word(word.substr(0, 1), request)) {
    return Error{ErrorCode::malformed,
                 "'" + excerpt(word) + "' is not a parameter like v=0.3, in the knot domain"};
  }
  request.parameter = *parameter;
  return {};
}

// Parses a degree or the number of copies of a knot. Each is from 1 to max_degree.
Status parse_number_word(const std::string& word, ChangeRequest& request) {
  const auto number = parse_whole_text<int>(word);
  if (!number || *number < 1 || *number > max_degree) {
    return Error{ErrorCode::out_of_range,
                 "'" + excerpt(word) + "' is not a whole number from 1 to " + std::to_string(max_degree)};
  }
  request.number = *number;
  return {};
}

Status parse_side_word(const std::string& word, ChangeRequest& request) {
  const auto side = parse_side(word);
  if (!side) return side.error();
  request.side = side.value();
  return {};
}

Status parse_height_word(const std::string& word, ChangeRequest& request) {
  const auto height_m = parse_length(word, cap_height_range_m);
  if (!height_m) return height_m.error();
  request.height_m = height_m.value();
  return {};
}

Result<ChangedSurfaces> exact_change(Result<Surface> surface, bool keeps_parameters) {
  if (!surface) return surface.error();
  return ChangedSurfaces{{std::move(surface).value()}, {}, 0.0, keeps_parameters};
}

Result<ChangedSurfaces> approximate_change(Result<Approximation> result) {
  if (!result) return result.error();
  return ChangedSurfaces{{std::move(result->surface)}, {}, result->deviation_m, true};
}

Result<ChangedSurfaces> split_surface(const Surface& surface, const ChangeRequest& request, const Allowed&) {
  const KnotVector& knots = knots_along(surface, request.direction);
  if (knots.is_periodic()) {
    // A closed direction has no ends, so a single cut opens it and leaves one part.
    return exact_change(part_of(surface, request.direction, request.parameter,
                                request.parameter + knots.domain_end() - knots.domain_start()),
                        false);
  }
  auto first = part_of(surface, request.direction, knots.domain_start(), request.parameter);
  if (!first) return first.error();
  auto second = part_of(surface, request.direction, request.parameter, knots.domain_end());
  if (!second) return second.error();
  return ChangedSurfaces{{std::move(first).value(), std::move(second).value()}, {}, 0.0, false};
}

Result<ChangedSurfaces> insert_knot_copies(const Surface& surface, const ChangeRequest& request,
                                           const Allowed&) {
  const KnotVector& knots = knots_along(surface, request.direction);
  const double near = same_knot_fraction * knots.domain_length();
  for (const double knot : knots.breakpoints()) {
    if (knot == request.parameter || std::abs(knot - request.parameter) > near) continue;
    return Error{ErrorCode::out_of_range, "a knot at " + number_text(request.parameter) +
                                              " is too near the one at " + number_text(knot) +
                                              "; insert it there, or farther away"};
  }
  return exact_change(insert_knot(surface, request.direction, request.parameter, request.number), true);
}

Result<ChangedSurfaces> remove_knot_copies(const Surface& surface, const ChangeRequest& request,
                                           const Allowed& allowed) {
  auto fewer = remove_knot(surface, request.direction, request.parameter, request.number);
  if (fewer && fewer->deviation_m > allowed.tolerance_m) {
    return Error{ErrorCode::not_converged,
                 "removing the knot at " + number_text(request.parameter) + " leaves a deviation of " +
                     short_length_text(fewer->deviation_m) + "; allow a larger --tolerance than " +
                     short_length_text(allowed.tolerance_m) + ", or remove the knot fewer times",
                 "--tolerance"};
  }
  return approximate_change(std::move(fewer));
}

Result<ChangedSurfaces> set_degree(const Surface& surface, const ChangeRequest& request,
                                   const Allowed& allowed) {
  const KnotVector& knots = knots_along(surface, request.direction);
  if (request.number >= knots.degree()) {
    const auto higher = elevate_degree(knots, request.number);
    if (!higher) return higher.error();
    if (higher->control_point_count() > control_points_limit) {
      return Error{ErrorCode::too_many, "degree " + std::to_string(request.number) + " needs " +
                                            std::to_string(higher->control_point_count()) +
                                            " control points, and a document holds " +
                                            std::to_string(control_points_limit) +
                                            "; simplify first, or choose a lower degree"};
    }
    return exact_change(convert_to_finer_knots(surface, request.direction, higher.value()), true);
  }
  const auto lower = reduce_degree(knots, request.number);
  if (!lower) return lower.error();
  return approximate_change(approximated(surface, request.direction, lower.value(), allowed.tolerance_m,
                                         sculpted_control_point_count_range.high, allowed.progress));
}

Result<ChangedSurfaces> remove_spare_knots(const Surface& surface, const ChangeRequest&,
                                           const Allowed& allowed) {
  auto along_u =
      remove_spare_knots(surface, Direction::u, 0.5 * allowed.tolerance_m, allowed.progress.part(0.0, 0.5));
  if (!along_u) return along_u.error();
  auto both = remove_spare_knots(along_u->surface, Direction::v, 0.5 * allowed.tolerance_m,
                                 allowed.progress.part(0.5, 1.0));
  if (!both) return both.error();
  return ChangedSurfaces{{std::move(both->surface)}, {}, along_u->deviation_m + both->deviation_m, true};
}

// Returns knots with the same degree, domain and closure for `count` control points. They are as dense along
// the direction as the given knots, in proportion.
Result<KnotVector> thin_out(const KnotVector& knots, int count) {
  const std::vector<double> breaks = knots.breakpoints();
  const int elements = knots.is_periodic() ? count : count - knots.degree();
  if (elements < 1 || count > knots.control_point_count()) {
    const int least = knots.is_periodic() ? 2 : knots.degree() + 1;
    return Error{ErrorCode::out_of_range,
                 "rebuild: " + std::to_string(count) + " control points, must be from " +
                     std::to_string(least) + " to the " + std::to_string(knots.control_point_count()) +
                     " of the surface",
                 "--control"};
  }
  std::vector<double> fewer;
  for (int k = 0; k <= elements; ++k) {
    const double place = static_cast<double>(breaks.size() - 1) * k / elements;
    const auto below = std::min(static_cast<std::size_t>(place), breaks.size() - 2);
    const double part = place - static_cast<double>(below);
    fewer.push_back((1.0 - part) * breaks[below] + part * breaks[below + 1]);
  }
  fewer.back() = breaks.back();
  if (knots.is_periodic()) return KnotVector::periodic(knots.degree(), std::move(fewer));
  const auto degree = static_cast<std::size_t>(knots.degree());
  fewer.insert(fewer.begin(), degree, breaks.front());
  fewer.insert(fewer.end(), degree, breaks.back());
  return KnotVector::open(knots.degree(), std::move(fewer));
}

Result<ChangedSurfaces> rebuild_net(const Surface& surface, const ChangeRequest& request, const Allowed&) {
  const auto u = thin_out(surface.u, request.control[0]);
  if (!u) return u.error();
  const auto v = thin_out(surface.v, request.control[1]);
  if (!v) return v.error();
  auto along_u = fit_coarser_knots(surface, Direction::u, u.value());
  if (!along_u) return along_u.error();
  auto both = fit_coarser_knots(along_u->surface, Direction::v, v.value());
  if (!both) return both.error();
  return ChangedSurfaces{{std::move(both->surface)}, {}, along_u->deviation_m + both->deviation_m, true};
}

Result<ChangedSurfaces> reverse_direction(const Surface& surface, const ChangeRequest& request,
                                          const Allowed&) {
  return exact_change(reversed(surface, request.direction), false);
}

Result<ChangedSurfaces> exchange_directions(const Surface& surface, const ChangeRequest&, const Allowed&) {
  return exact_change(exchanged(surface), false);
}

Result<ChangedSurfaces> move_seam(const Surface& surface, const ChangeRequest& request, const Allowed&) {
  return exact_change(with_seam_at(surface, request.direction, request.parameter), false);
}

Result<ChangedSurfaces> close_around(const Surface& surface, const ChangeRequest& request,
                                     const Allowed& allowed) {
  auto closed =
      close_around(surface, request.direction, request.continuity, allowed.tolerance_m, allowed.progress);
  if (!closed) return closed.error();
  return ChangedSurfaces{{std::move(closed->surface)}, {}, closed->deviation_m, true};
}

Result<ChangedSurfaces> add_cap(const Surface& surface, const ChangeRequest& request,
                                const Allowed& allowed) {
  JoinRequest join;
  join.tolerance_m = allowed.tolerance_m;
  join.progress = allowed.progress;
  auto capped = add_cap(surface, request.side, request.height_m, join);
  if (!capped) return capped.error();
  return ChangedSurfaces{{std::move(capped->surface)}, {}, capped->deviation_m, false};
}

Result<ChangedSurfaces> open_end(const Surface& surface, const ChangeRequest& request, const Allowed&) {
  return exact_change(open_pole(surface, request.side, HUGE_VAL), false);
}

TrimLoop reverse_trim(const Surface& surface, const ChangeRequest& request, const TrimLoop& loop) {
  return reversed(loop, request.direction, knots_along(surface, request.direction));
}

TrimLoop exchange_trim(const Surface&, const ChangeRequest&, const TrimLoop& loop) {
  return exchanged(loop);
}

TrimLoop move_trims_seam(const Surface& surface, const ChangeRequest& request, const TrimLoop& loop) {
  return with_seam_at(loop, request.direction, knots_along(surface, request.direction), request.parameter);
}

Status map_trims(const Change& change, const Surface& surface, const ChangeRequest& request,
                 const std::vector<TrimLoop>& trims, ChangedSurfaces& changed) {
  if (trims.empty() || changed.keeps_parameters) {
    changed.trims = trims;
    return {};
  }
  if (!change.map_trim) {
    return Error{
        ErrorCode::unsupported,
        std::string("'") + change.name +
            "' would lose the surface's trims; resample it without trims first, with `spoonbill merge` "
            "of this model alone"};
  }
  for (const TrimLoop& loop : trims) changed.trims.push_back(change.map_trim(surface, request, loop));
  return {};
}

const std::vector<Change>& all_changes() {
  static const WordParsers none, parameter{parse_parameter_word},
      knots{parse_parameter_word, parse_number_word}, direction{parse_direction_word},
      degree{parse_direction_word, parse_number_word}, end{parse_side_word},
      bulge{parse_side_word, parse_height_word};
  static const std::vector<Change> changes{
      {ChangeKind::split, parameter, 1, split_surface, nullptr, "split", "v=0.5",
       "cut in two at a parameter; a closed direction is only opened"},
      {ChangeKind::insert, knots, 1, insert_knot_copies, nullptr, "insert", "v=0.5 [2]",
       "insert a knot, 1 or more times; exact"},
      {ChangeKind::remove, knots, 1, remove_knot_copies, nullptr, "remove", "v=0.5 [2]",
       "remove a knot, 1 or more times, within the tolerance"},
      {ChangeKind::degree, degree, 2, set_degree, nullptr, "degree", "v 5",
       "raise the degree (exact) or lower it within the tolerance"},
      {ChangeKind::simplify, none, 0, remove_spare_knots, nullptr, "simplify", "",
       "remove all knots that the tolerance allows"},
      {ChangeKind::rebuild, none, 0, rebuild_net, nullptr, "rebuild", "",
       "reduce the net to --control points; reports the deviation"},
      {ChangeKind::reverse, direction, 1, reverse_direction, reverse_trim, "reverse", "v",
       "reverse a direction; flips the normals"},
      {ChangeKind::exchange, none, 0, exchange_directions, exchange_trim, "exchange", "",
       "swap u and v; flips the normals"},
      {ChangeKind::seam, parameter, 1, move_seam, move_trims_seam, "seam", "u=0.25",
       "move the seam of a closed direction to a parameter"},
      {ChangeKind::close, direction, 1, close_around, nullptr, "close", "u",
       "close a direction whose first and last edges meet"},
      {ChangeKind::cap, bulge, 1, add_cap, nullptr, "cap", "v_end [3mm]",
       "close an open end of a tube, flat or with a bulge of this height"},
      {ChangeKind::open, end, 1, open_end, nullptr, "open", "v_end",
       "cut off the pole, up to where the sides become straight"}};
  return changes;
}

}  // namespace

Result<ChangeRequest> parse_change(const std::vector<std::string>& words) {
  std::string known = placing_names();
  for (const Change& change : all_changes()) {
    known += ", " + std::string(change.name);
    if (words.empty() || words[0] != change.name) continue;
    if (words.size() < 1 + change.fewest_words || words.size() > 1 + change.words.size()) {
      return Error{ErrorCode::malformed,
                   "'" + words[0] + "' must have the form: " + change.name + " " + change.form};
    }
    ChangeRequest request{change.kind};
    for (std::size_t k = 1; k < words.size(); ++k) {
      if (Status parsed = change.words[k - 1](words[k], request); !parsed) return parsed.error();
    }
    return request;
  }
  return Error{ErrorCode::unknown,
               "'" + (words.empty() ? "" : excerpt(words[0])) + "' is not a change; choose from " + known};
}

Result<ChangedSurfaces> change_surface(const Surface& surface, const std::vector<TrimLoop>& trims,
                                       const ChangeRequest& request, double tolerance_m,
                                       const Progress& progress) {
  const auto change = std::find_if(all_changes().begin(), all_changes().end(),
                                   [&](const Change& one) { return one.kind == request.kind; });
  auto result = change->make(surface, request, {tolerance_m, progress});
  if (!result) return result;
  if (Status mapped = map_trims(*change, surface, request, trims, result.value()); !mapped) {
    return mapped.error();
  }
  return result;
}

std::string list_changes() {
  std::string text;
  for (const Change& change : all_changes()) {
    std::string left = std::string("  ") + change.name + " " + change.form;
    left.resize(std::max<std::size_t>(left.size() + 2, 24), ' ');
    text += left + change.description + "\n";
  }
  return text;
}

void drop_surface_features(Body& body, std::vector<std::string>& notes) {
  std::string dropped;
  const auto drop = [&](auto& features, const char* what) {
    if (!features.empty()) dropped += (dropped.empty() ? "" : ", ") + std::string(what);
    features.clear();
  };
  drop(body.regions, "regions");
  drop(body.loads, "loads");
  drop(body.supports, "supports");
  drop(body.rim, "rim");
  if (dropped.empty()) return;
  notes.push_back("\"" + body.name + "\" lost its " + dropped + ": the positions refer to the old surface");
}

void adapt_thickness(Body& body, const Surface& before, std::vector<std::string>& notes) {
  const bool was_solid = find_closing(before).closedness == Closedness::solid;
  const bool solid = find_closing(body.surface).closedness == Closedness::solid;
  if (solid == was_solid) return;
  if (solid && body.shell_thickness_m) {
    body.shell_thickness_m.reset();
    notes.push_back("the shell thickness of \"" + body.name + "\" was dropped: the body became a solid");
  } else if (!solid && !body.shell_thickness_m) {
    notes.push_back("\"" + body.name + "\" is open; add shell_thickness_mm to its file to sculpt it");
  }
}

}  // namespace spoonbill
