// Spreads the nodes inside a lattice evenly through its body: the volumetric self-organising feature map of
// section 4.3 of Pungotra et al. 2013.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/progress.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

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

// Who waits for a map.
struct FeatureMapWatch {
  Progress progress;                                  // stops the map, with nothing moved
  std::function<void(const FeatureMapReport&)> done;  // called on the thread that makes it; may be empty
};

// Moves the nodes that are not on the shell. The same seed gives the same nodes. The worst Jacobian never
// falls.
FeatureMapReport order_by_feature_map(LatticeMesh& mesh, const FeatureMapSettings& settings,
                                      const FeatureMapWatch& watch = {});

}  // namespace spoonbill
