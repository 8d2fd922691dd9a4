// Lattices of bodies: shells, and solids as one block of cells bent into a tube or as a box of cells.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Returns the lattice of a body of a scene at rest, solid or shell. Fails where solid_lattice() or
// shell_lattice() does. `watch` receives the progress of a feature map.
Result<LatticeMesh> make_body_lattice(const Body& body, const FeatureMapWatch& watch = {});

// Returns the lattice of a closed body: that of tube_lattice() if the body is a tube and no cell folds,
// otherwise that of surface_in_box(). Fails where check_closed() does, on bodies too flat for cells, and on
// counts below 2. `watch` receives the progress of a feature map.
Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch = {});

// Returns the lattice of a closed tube-like or box-like body. Slices are at constant v, evenly spaced along
// the body. The nodes of a ring are spaced by arc length; spacing by angle would give slender cells and twice
// as many substeps. The two end slices are on the caps.
//
// If cells fold, as in a body that is hollow at a pole, the caps reach to the shoulders, and the interior
// nodes follow the whole hull and are unfolded. Fails on a surface that is not a closed tube, counts below
// 2, and cells that remain folded. `watch` receives the progress of a feature map.
Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch = {});

}  // namespace spoonbill
