// The islands of a scan: parts that nothing joins.
#pragma once

#include <vector>

#include "engine/fitting/fit_points.h"

namespace spoonbill {

// What is less than this share of the largest island, or has fewer nodes, is dust.
inline constexpr double dust_share = 0.02;
inline constexpr std::size_t least_island_nodes = 30;

// Each with points, nodes and rims of its own, the largest first. Dust is left out and counted.
struct Islands {
  std::vector<FitPoints> islands;
  std::size_t dust_points = 0;
};
Islands split_islands(const FitPoints& points);

}  // namespace spoonbill
