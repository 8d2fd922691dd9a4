// The changes of a surface that the change command knows, by the words that ask for them. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

struct ChangedSurfaces {
  std::vector<Surface> surfaces;  // two after a split
  std::vector<TrimLoop> trims = {};
  double deviation_m = 0.0;      // zero where the change is exact
  bool keeps_parameters = true;  // so that regions, loads and supports stay where they were
};

enum class ChangeKind { split, insert, remove, degree, simplify, reverse, exchange, seam, close, cap, open };

// What the words mean; only what the kind asks for has a meaning.
struct AskedChange {
  ChangeKind kind = ChangeKind::simplify;
  Direction direction = Direction::u;
  double parameter = 0.0;  // of the direction
  int number = 1;          // a degree, or how many copies of a knot
  Side side = Side::v_end;
  double height_m = 0.0;  // of a cap
  int continuity = 2;     // of the seam where a direction is closed
};

// Of words such as {"insert", "v=0.3", "2"}. Refused: those that no surface could make sense of.
Result<AskedChange> parse_change(const std::vector<std::string>& words);

// `tolerance_m` is for the changes that cannot be exact, which can be stopped. Trims stay or turn with
// the surface; changes that would lose them are refused.
Result<ChangedSurfaces> changed(const Surface& surface, const std::vector<TrimLoop>& trims,
                                const AskedChange& asked, double tolerance_m, const Progress& progress = {});

// One line for each change, for --help.
std::string changes_text();

}  // namespace spoonbill
