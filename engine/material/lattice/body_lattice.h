// Lattices of bodies. A shell consists of layers of cells, a solid of one block of cells bent into a tube or
// of a box of cells.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Returns the lattice of a body of a scene at rest, solid or shell. Fails where solid_lattice() or
// shell_lattice() does. `watch` receives the progress of order_by_feature_map(), if the body requests it.
Result<LatticeMesh> make_body_lattice(const Body& body, const FeatureMapWatch& watch = {});

// Returns the lattice of a closed body: that of tube_lattice() if the body is a tube and no cell folds,
// otherwise that of surface_in_box(). Fails where check_closed() does, on bodies too flat for cells, and on
// counts below 2. `watch` receives the progress of order_by_feature_map().
Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch = {});

// Returns the lattice of a closed tube-like or box-like body. Slices of nodes are at constant v, evenly
// spaced along the body. The nodes around a slice are spaced by arc length; spacing by angle would give
// slender cells and twice as many substeps. The nodes of the two end slices are on the caps of the tube.
//
// If cells fold, as in a body that is hollow at a pole, a second attempt uses larger caps, which reach to the
// shoulders (shoulder_rims()). It interpolates the interior nodes from the whole hull and then unfolds the
// cells. Fails on a surface that is not a closed tube, counts below 2, and cells that remain folded. `watch`
// receives the progress of order_by_feature_map().
Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch = {});

}  // namespace spoonbill
