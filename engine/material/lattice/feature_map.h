// Even distribution of the nodes inside a body by the volumetric self-organising feature map of section 4.3
// of Pungotra et al. 2013.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/progress.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Quality of the cells of a lattice.
struct CellQuality {
  double worst_jacobian = 0.0;  // see smallest_jacobian_ratio(); 1 for boxes
  double volume_spread = 0.0;   // standard deviation of the cell volumes divided by their mean
};
CellQuality measure_cell_quality(const LatticeMesh& mesh);

struct FeatureMapReport {
  CellQuality before, after;
  // Applied displacements as a fraction of those that the map requested. Displacements are shortened so that
  // the worst cell gets no worse.
  double applied_fraction = 0.0;
};

// Observer of a feature map computation.
struct FeatureMapWatch {
  Progress progress;                                  // cancelling it leaves the mesh unchanged
  std::function<void(const FeatureMapReport&)> done;  // called on the computing thread; may be empty
};

// Distributes the nodes inside the body evenly; nodes on its surface stay. The same seed gives the same
// nodes. The worst Jacobian never falls.
FeatureMapReport order_by_feature_map(LatticeMesh& mesh, const FeatureMapSettings& settings,
                                      const FeatureMapWatch& watch = {});

}  // namespace spoonbill
