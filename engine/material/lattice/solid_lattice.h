// The lattice of a closed body: one block of cells bent into it, or a box of cells about it.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// That of tube_lattice() where the body is a tube and it does not fold, otherwise that of surface_in_box().
// Refused: what check_closed() refuses, what is too flat, counts below 2. `watch` is told how a feature map
// comes along.
Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch = {});

}  // namespace spoonbill
