#include "engine/merging/arrangement.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"

namespace spoonbill {

namespace {

struct Place {
  int a = 0, b = 0;
  Orientation orientation;

  friend bool operator==(const Place&, const Place&) = default;
};

constexpr bool both[] = {false, true};

// The one way to turn a patch so that its side faces a given one and runs along with it.
std::optional<Orientation> facing(Side side, Side wanted, bool reversed) {
  for (const bool exchange : both) {
    for (const bool reverse_u : both) {
      for (const bool reverse_v : both) {
        const Orientation orientation{exchange, reverse_u, reverse_v};
        const TurnedSide result = turned(side, orientation);
        if (result.side == wanted && result.reversed == reversed) return orientation;
      }
    }
  }
  return std::nullopt;
}

Place neighbour(const Place& place, Side own, Side other, bool against) {
  const TurnedSide here = turned(own, place.orientation);
  Place there = place;
  int& moved = across(here.side) == Direction::u ? there.a : there.b;
  moved += is_start(here.side) ? -1 : 1;
  there.orientation = *facing(other, opposite(here.side), here.reversed != against);
  return there;
}

std::vector<std::optional<Place>> places_of(std::size_t count, const std::vector<EdgeMatch>& matches) {
  std::vector<std::optional<Place>> places(count);
  places[0] = Place{};
  for (bool more = true; more;) {
    more = false;
    for (const EdgeMatch& match : matches) {
      auto &a = places[match.a.patch], &b = places[match.b.patch];
      if (a.has_value() == b.has_value()) continue;
      if (a) {
        b = neighbour(*a, match.a.side, match.b.side, match.reversed);
      } else {
        a = neighbour(*b, match.b.side, match.a.side, match.reversed);
      }
      more = true;
    }
  }
  return places;
}

Error layout_error(int patch, const char* what) {
  return Error{"patch " + std::to_string(patch + 1) + " " + what +
               "; merge patches that make a row or a full grid, or name the edges"};
}

// The matches that do not lead from a patch to where the other one lies: by one they close the grid around,
// if every row or column has one.
void sort_mismatches(const std::vector<std::optional<Place>>& places, const std::vector<EdgeMatch>& matches,
                     Arrangement& arrangement) {
  arrangement.closing_u.clear();
  arrangement.closing_v.clear();
  arrangement.left_open.clear();
  for (const EdgeMatch& match : matches) {
    const Place &there = *places[match.b.patch],
                beside = neighbour(*places[match.a.patch], match.a.side, match.b.side, match.reversed);
    if (beside == there) continue;
    const int da = std::abs(beside.a - there.a), db = std::abs(beside.b - there.b);
    const bool held_alike = beside.orientation == there.orientation;
    if (held_alike && da == arrangement.rows && db == 0) {
      arrangement.closing_u.push_back(match);
    } else if (held_alike && db == arrangement.columns && da == 0) {
      arrangement.closing_v.push_back(match);
    } else {
      arrangement.left_open.push_back(match);
    }
  }
  const auto open_unless_all = [&](std::vector<EdgeMatch>& closing, int count) {
    if (static_cast<int>(closing.size()) == count) return;
    arrangement.left_open.insert(arrangement.left_open.end(), closing.begin(), closing.end());
    closing.clear();
  };
  open_unless_all(arrangement.closing_u, arrangement.columns);
  open_unless_all(arrangement.closing_v, arrangement.rows);
}

// So that the seam of a ring lies before the first patch, which is at 0.
bool start_rings_at_first(const Arrangement& arrangement, std::vector<std::optional<Place>>& places) {
  const auto wrapped = [](int place, int count) { return (place % count + count) % count; };
  for (std::optional<Place>& place : places) {
    if (!arrangement.closing_u.empty()) place->a = wrapped(place->a, arrangement.rows);
    if (!arrangement.closing_v.empty()) place->b = wrapped(place->b, arrangement.columns);
  }
  return !arrangement.closing_u.empty() || !arrangement.closing_v.empty();
}

Result<Arrangement> with_cells(Arrangement arrangement, const std::vector<std::optional<Place>>& places,
                               int low_a, int low_b) {
  const std::size_t cells = static_cast<std::size_t>(arrangement.rows) * arrangement.columns;
  arrangement.patches.assign(cells, -1);
  arrangement.orientations.resize(cells);
  for (std::size_t p = 0; p < places.size(); ++p) {
    const int cell = arrangement.cell(places[p]->a - low_a, places[p]->b - low_b);
    if (arrangement.patches[cell] >= 0) {
      return layout_error(static_cast<int>(p), "lies where another one does");
    }
    arrangement.patches[cell] = static_cast<int>(p);
    arrangement.orientations[cell] = places[p]->orientation;
  }
  for (const int patch : arrangement.patches) {
    if (patch < 0) return layout_error(static_cast<int>(places.size()) - 1, "leaves a gap in the grid");
  }
  return arrangement;
}

}  // namespace

Surface oriented(const Surface& surface, const Orientation& orientation) {
  Surface result = orientation.exchanged ? exchanged(surface) : surface;
  if (orientation.reversed_u) result = reversed(result, Direction::u);
  if (orientation.reversed_v) result = reversed(result, Direction::v);
  return result;
}

TurnedSide turned(Side side, const Orientation& orientation) {
  Direction direction = across(side);
  bool start = is_start(side);
  if (orientation.exchanged) direction = direction == Direction::u ? Direction::v : Direction::u;
  const bool across_reversed = direction == Direction::u ? orientation.reversed_u : orientation.reversed_v;
  const bool along_reversed = direction == Direction::u ? orientation.reversed_v : orientation.reversed_u;
  if (across_reversed) start = !start;
  const Side result = direction == Direction::u ? (start ? Side::u_start : Side::u_end)
                                                : (start ? Side::v_start : Side::v_end);
  return {result, along_reversed};
}

Result<Arrangement> arrange(const std::vector<Surface>& patches, const std::vector<EdgeMatch>& matches) {
  SPOONBILL_ASSERT(!patches.empty());
  auto places = places_of(patches.size(), matches);
  int low_a = 0, low_b = 0, high_a = 0, high_b = 0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!places[p]) return layout_error(static_cast<int>(p), "hangs on no other");
    low_a = std::min(low_a, places[p]->a);
    high_a = std::max(high_a, places[p]->a);
    low_b = std::min(low_b, places[p]->b);
    high_b = std::max(high_b, places[p]->b);
  }
  Arrangement arrangement;
  arrangement.rows = high_a - low_a + 1;
  arrangement.columns = high_b - low_b + 1;
  sort_mismatches(places, matches, arrangement);
  if (start_rings_at_first(arrangement, places)) sort_mismatches(places, matches, arrangement);
  if (!arrangement.closing_u.empty()) low_a = 0;
  if (!arrangement.closing_v.empty()) low_b = 0;
  return with_cells(std::move(arrangement), places, low_a, low_b);
}

}  // namespace spoonbill
