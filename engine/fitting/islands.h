// Connected components of a scan, and the gaps that separate them.
#pragma once

#include <vector>

#include "engine/fitting/fit_points.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Removes the pairs of nodes that bridge a gap between bodies and returns the others. `groups` assigns
// `points_m` to the nodes. A gap is at least three times as wide as the widest step between the points of
// either node. The surfaces on both sides of a gap face each other, unlike the two sides of an unscanned
// stripe of one surface. Both surfaces belong to bodies that are too large to count as dust (dust_fraction).
std::vector<NodePair> remove_gap_pairs(const std::vector<Vector3>& points_m, const VoxelGroups& groups,
                                       const std::vector<Vector3>& nodes_m, std::vector<NodePair> pairs);

// Limits below which a component counts as dust: the weight of its points as a fraction of the largest
// component's, and its number of nodes.
inline constexpr double dust_fraction = 0.02;
inline constexpr std::size_t least_island_nodes = 30;

// Connected components with their own points, nodes and boundary loops, largest first. Dust is dropped and
// counted.
struct Islands {
  std::vector<FitPoints> islands;
  std::size_t dust_points = 0;
};
Islands split_islands(const FitPoints& points);

}  // namespace spoonbill
