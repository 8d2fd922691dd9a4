// The changes of a surface that the change command knows, by the words that ask for them. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/result.h"

namespace spoonbill {

struct ChangedSurfaces {
  std::vector<Surface> surfaces;  // two after a split
  std::vector<TrimLoop> trims = {};
  double deviation_m = 0.0;      // zero where the change is exact
  bool keeps_parameters = true;  // so that regions, loads and supports stay where they were
};

// `words` such as {"insert", "v=0.3", "2"}; `tolerance_m` for the changes that cannot be exact. Trims stay or
// turn with the surface; changes that would lose them are refused.
Result<ChangedSurfaces> changed(const Surface& surface, const std::vector<TrimLoop>& trims,
                                const std::vector<std::string>& words, double tolerance_m);

// One line for each change, for --help.
std::string changes_text();

}  // namespace spoonbill
