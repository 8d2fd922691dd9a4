// The islands of a scan: parts that nothing joins.
#pragma once

#include <vector>

#include "engine/fitting/fit_points.h"

namespace spoonbill {

// Each with points, nodes and rims of its own, the largest first. Those of less than a fiftieth of the
// largest's weight, or too small to fit, are dust: left out and counted.
struct Islands {
  std::vector<FitPoints> islands;
  std::size_t dust_points = 0;
};
Islands split_islands(const FitPoints& points);

}  // namespace spoonbill
