#include "app/commands/surface_change.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "app/commands/option_values.h"
#include "engine/base/text.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {
namespace {

constexpr int control_points_limit = 200;
constexpr Range<double> cap_height_range_m{0.0, 1.0};

// What a change may cost.
struct Allowed {
  double tolerance_m;
  Progress progress;
};

// What the words after a change's name mean, in their order.
using Words = std::vector<Status (*)(const std::string& word, AskedChange& asked)>;

struct Change {
  ChangeKind kind;
  Words words;
  std::size_t fewest_words;
  Result<ChangedSurfaces> (*make)(const Surface& surface, const AskedChange& asked, const Allowed& allowed);
  // Where the change does not keep the parameters, what becomes of a trim loop; null where that is nothing.
  TrimLoop (*turn_trim)(const Surface& surface, const AskedChange& asked, const TrimLoop& loop);
  const char *name, *form, *what;
};

template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

Status take_direction(const std::string& word, AskedChange& asked) {
  if (word != "u" && word != "v") {
    return Error{"'" + excerpt(word) + "' is not a direction; say u or v"};
  }
  asked.direction = word == "u" ? Direction::u : Direction::v;
  return {};
}

// "v=0.3"
Status take_place(const std::string& word, AskedChange& asked) {
  const auto parameter =
      word.size() > 2 && word[1] == '=' ? number_of<double>(std::string_view(word).substr(2)) : std::nullopt;
  if (!parameter || !std::isfinite(*parameter) || !take_direction(word.substr(0, 1), asked)) {
    return Error{"'" + excerpt(word) + "' is not a place like v=0.3, in the knots' domain"};
  }
  asked.parameter = *parameter;
  return {};
}

// A degree, or how many times a knot is to be there, which is at most one.
Status take_number(const std::string& word, AskedChange& asked) {
  const auto number = number_of<int>(word);
  if (!number || *number < 1 || *number > max_degree) {
    return Error{"'" + excerpt(word) + "' is not a whole number from 1 to " + std::to_string(max_degree)};
  }
  asked.number = *number;
  return {};
}

Status take_side(const std::string& word, AskedChange& asked) {
  const auto side = parse_side(word);
  if (!side) return side.error();
  asked.side = side.value();
  return {};
}

Status take_height(const std::string& word, AskedChange& asked) {
  const auto height_m = parse_length(word, cap_height_range_m);
  if (!height_m) return height_m.error();
  asked.height_m = height_m.value();
  return {};
}

Result<ChangedSurfaces> exactly(Result<Surface> surface, bool keeps_parameters) {
  if (!surface) return surface.error();
  return ChangedSurfaces{{std::move(surface).value()}, {}, 0.0, keeps_parameters};
}

Result<ChangedSurfaces> nearly(Result<Approximation> result) {
  if (!result) return result.error();
  return ChangedSurfaces{{std::move(result->surface)}, {}, result->deviation_m, true};
}

Result<ChangedSurfaces> split(const Surface& surface, const AskedChange& asked, const Allowed&) {
  const KnotVector& knots = knots_along(surface, asked.direction);
  if (knots.is_periodic()) {
    // Around a seam there is one cut.
    return exactly(part_of(surface, asked.direction, asked.parameter,
                           asked.parameter + knots.domain_end() - knots.domain_start()),
                   false);
  }
  auto first = part_of(surface, asked.direction, knots.domain_start(), asked.parameter);
  if (!first) return first.error();
  auto second = part_of(surface, asked.direction, asked.parameter, knots.domain_end());
  if (!second) return second.error();
  return ChangedSurfaces{{std::move(first).value(), std::move(second).value()}, {}, 0.0, false};
}

Result<ChangedSurfaces> insert(const Surface& surface, const AskedChange& asked, const Allowed&) {
  const KnotVector& knots = knots_along(surface, asked.direction);
  const double near = same_knot_fraction * (knots.domain_end() - knots.domain_start());
  for (const double knot : knots.breakpoints()) {
    if (knot == asked.parameter || std::abs(knot - asked.parameter) > near) continue;
    return Error{"a knot at " + number_text(asked.parameter) + " is too near the one at " +
                 number_text(knot) + " to be kept apart; insert it there, or farther away"};
  }
  return exactly(insert_knot(surface, asked.direction, asked.parameter, asked.number), true);
}

Result<ChangedSurfaces> remove(const Surface& surface, const AskedChange& asked, const Allowed& allowed) {
  auto fewer = remove_knot(surface, asked.direction, asked.parameter, asked.number);
  if (fewer && fewer->deviation_m > allowed.tolerance_m) {
    return Error{"to take the knot at " + number_text(asked.parameter) + " out leaves a deviation of " +
                 short_length_text(fewer->deviation_m) + "; allow a larger tolerance than " +
                 short_length_text(allowed.tolerance_m) + ", or take it out fewer times"};
  }
  return nearly(std::move(fewer));
}

Result<ChangedSurfaces> set_degree(const Surface& surface, const AskedChange& asked, const Allowed& allowed) {
  const KnotVector& knots = knots_along(surface, asked.direction);
  if (asked.number >= knots.degree()) {
    const auto higher = elevate_degree(knots, asked.number);
    if (!higher) return higher.error();
    if (higher->control_point_count() > control_points_limit) {
      return Error{"degree " + std::to_string(asked.number) + " takes " +
                   std::to_string(higher->control_point_count()) + " control points, a document holds " +
                   std::to_string(control_points_limit) + "; simplify first, or ask for less"};
    }
    return exactly(convert_to_finer_knots(surface, asked.direction, higher.value()), true);
  }
  const auto lower = reduce_degree(knots, asked.number);
  if (!lower) return lower.error();
  return nearly(approximated(surface, asked.direction, lower.value(), allowed.tolerance_m,
                             control_points_limit, allowed.progress));
}

Result<ChangedSurfaces> simplify(const Surface& surface, const AskedChange&, const Allowed& allowed) {
  auto along_u =
      remove_spare_knots(surface, Direction::u, 0.5 * allowed.tolerance_m, allowed.progress.part(0.0, 0.5));
  if (!along_u) return along_u.error();
  auto both = remove_spare_knots(along_u->surface, Direction::v, 0.5 * allowed.tolerance_m,
                                  allowed.progress.part(0.5, 1.0));
  if (!both) return both.error();
  return ChangedSurfaces{{std::move(both->surface)}, {}, along_u->deviation_m + both->deviation_m, true};
}

Result<ChangedSurfaces> reverse(const Surface& surface, const AskedChange& asked, const Allowed&) {
  return exactly(reversed(surface, asked.direction), false);
}

Result<ChangedSurfaces> exchange(const Surface& surface, const AskedChange&, const Allowed&) {
  return exactly(exchanged(surface), false);
}

Result<ChangedSurfaces> move_seam(const Surface& surface, const AskedChange& asked, const Allowed&) {
  return exactly(with_seam_at(surface, asked.direction, asked.parameter), false);
}

Result<ChangedSurfaces> close_around(const Surface& surface, const AskedChange& asked,
                                     const Allowed& allowed) {
  auto closed =
      close_around(surface, asked.direction, asked.continuity, allowed.tolerance_m, allowed.progress);
  if (!closed) return closed.error();
  return ChangedSurfaces{{std::move(closed->surface)}, {}, closed->deviation_m, true};
}

Result<ChangedSurfaces> cap(const Surface& surface, const AskedChange& asked, const Allowed& allowed) {
  JoinRequest request;
  request.tolerance_m = allowed.tolerance_m;
  request.progress = allowed.progress;
  auto capped = add_cap(surface, asked.side, asked.height_m, request);
  if (!capped) return capped.error();
  return ChangedSurfaces{{std::move(capped->surface)}, {}, capped->deviation_m, false};
}

Result<ChangedSurfaces> open_end(const Surface& surface, const AskedChange& asked, const Allowed&) {
  return exactly(open_pole(surface, asked.side, HUGE_VAL), false);
}

TrimLoop reverse_trim(const Surface& surface, const AskedChange& asked, const TrimLoop& loop) {
  return reversed(loop, asked.direction, knots_along(surface, asked.direction));
}

TrimLoop exchange_trim(const Surface&, const AskedChange&, const TrimLoop& loop) {
  return exchanged(loop);
}

TrimLoop move_trims_seam(const Surface& surface, const AskedChange& asked, const TrimLoop& loop) {
  return with_seam_at(loop, asked.direction, knots_along(surface, asked.direction), asked.parameter);
}

Status turn_trims(const Change& change, const Surface& surface, const AskedChange& asked,
                  const std::vector<TrimLoop>& trims, ChangedSurfaces& changed) {
  if (trims.empty() || changed.keeps_parameters) {
    changed.trims = trims;
    return {};
  }
  if (!change.turn_trim) {
    return Error{std::string("'") + change.name +
                 "' would lose its trims; make it whole first, by `spoonbill merge` of it alone"};
  }
  for (const TrimLoop& loop : trims) changed.trims.push_back(change.turn_trim(surface, asked, loop));
  return {};
}

const std::vector<Change>& all_changes() {
  static const Words none, place{take_place}, knots{take_place, take_number}, way{take_direction},
      degree{take_direction, take_number}, end{take_side}, bulge{take_side, take_height};
  static const std::vector<Change> changes{
      {ChangeKind::split, place, 1, split, nullptr, "split", "v=0.5",
       "cut in two there, or open around where it is closed"},
      {ChangeKind::insert, knots, 1, insert, nullptr, "insert", "v=0.5 [2]", "a knot, so many times; exact"},
      {ChangeKind::remove, knots, 1, remove, nullptr, "remove", "v=0.5 [2]",
       "a knot, so many times, within the tolerance"},
      {ChangeKind::degree, degree, 2, set_degree, nullptr, "degree", "v 5",
       "raise the degree (exact) or lower it within the tolerance"},
      {ChangeKind::simplify, none, 0, simplify, nullptr, "simplify", "",
       "remove the knots that the tolerance can spare"},
      {ChangeKind::reverse, way, 1, reverse, reverse_trim, "reverse", "v",
       "run through a direction backwards; turns the normals"},
      {ChangeKind::exchange, none, 0, exchange, exchange_trim, "exchange", "",
       "u becomes v and v becomes u; turns the normals"},
      {ChangeKind::seam, place, 1, move_seam, move_trims_seam, "seam", "u=0.25",
       "begin the closed direction there"},
      {ChangeKind::close, way, 1, close_around, nullptr, "close", "u",
       "close around where the first and the last edge meet"},
      {ChangeKind::cap, bulge, 1, cap, nullptr, "cap", "v_end [3mm]",
       "close an open end of a tube, flat or bulging so far"},
      {ChangeKind::open, end, 1, open_end, nullptr, "open", "v_end",
       "cut the pole off where the sides begin to run straight"}};
  return changes;
}

}  // namespace

Result<AskedChange> parse_change(const std::vector<std::string>& words) {
  std::string known;
  for (const Change& change : all_changes()) {
    known += (known.empty() ? "" : ", ") + std::string(change.name);
    if (words.empty() || words[0] != change.name) continue;
    if (words.size() < 1 + change.fewest_words || words.size() > 1 + change.words.size()) {
      return Error{"'" + words[0] + "' is asked for as: " + change.name + " " + change.form};
    }
    AskedChange asked{change.kind};
    for (std::size_t k = 1; k < words.size(); ++k) {
      if (Status taken = change.words[k - 1](words[k], asked); !taken) return taken.error();
    }
    return asked;
  }
  return Error{"'" + (words.empty() ? "" : excerpt(words[0])) + "' is no change; choose from " + known};
}

Result<ChangedSurfaces> changed(const Surface& surface, const std::vector<TrimLoop>& trims,
                                const AskedChange& asked, double tolerance_m, const Progress& progress) {
  const auto change = std::find_if(all_changes().begin(), all_changes().end(),
                                   [&](const Change& one) { return one.kind == asked.kind; });
  auto result = change->make(surface, asked, {tolerance_m, progress});
  if (!result) return result;
  if (Status turned = turn_trims(*change, surface, asked, trims, result.value()); !turned) {
    return turned.error();
  }
  return result;
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
