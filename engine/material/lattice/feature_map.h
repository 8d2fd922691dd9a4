// Spreads the nodes inside a lattice evenly through its body: the volumetric self-organising feature map of
// section 4.3 of Pungotra et al. 2013.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/range.h"

namespace spoonbill {

// Points of the body are drawn at random; the node nearest to one, and its neighbours in the grid less and
// less, move towards it: w += rate * exp(-d^2 / 2 s^2) (x - w), d in steps of the grid. Rate and s shrink
// geometrically from their first to their last value (Kohonen 1990). Below about one step, neighbours no
// longer follow, and the map can get stuck folded (Erwin et al. 1992).
struct FeatureMapSettings {
  int draws_per_node = 500;  // of the nodes inside
  double first_rate = 0.1, last_rate = 0.01;
  double first_neighbourhood = 2.0, last_neighbourhood = 1.0;  // s, in steps of the grid
  std::uint32_t seed = 1;
  friend bool operator==(const FeatureMapSettings&, const FeatureMapSettings&) = default;
};

inline constexpr Range<int> draws_per_node_range{1, 10000};
inline constexpr Range<int> map_seed_range{0, 1000000000};
inline constexpr Range<double> map_rate_range{1e-6, 1.0};
inline constexpr Range<double> map_neighbourhood_range{0.5, 64.0};

Status check_feature_map(const FeatureMapSettings& settings);

// How good cells are, each 1 for a box: the smallest Jacobian over the volume, and how even volumes are.
struct CellQuality {
  double worst_jacobian = 0.0;  // see smallest_jacobian_ratio()
  double volume_spread = 0.0;   // the standard deviation of the cells' volumes over their mean
};
CellQuality quality_of(const LatticeMesh& mesh);

struct FeatureMapReport {
  CellQuality before, after;
  double share =
      0.0;  // how much of the map's moves was kept: all, or as much as makes no cell worse than the worst
};

// Who waits for a map. Called on the thread that makes it; either may be empty.
struct FeatureMapWatch {
  // Told a share from 0 to 1 now and then; stops the map, with nothing moved, by returning false.
  std::function<bool(double)> progress;
  std::function<void(const FeatureMapReport&)> done;
};

// Moves the nodes that are not on the shell. The same seed gives the same nodes. The worst Jacobian never
// falls.
FeatureMapReport order_by_feature_map(LatticeMesh& mesh, const FeatureMapSettings& settings,
                                      const FeatureMapWatch& watch = {});

}  // namespace spoonbill
