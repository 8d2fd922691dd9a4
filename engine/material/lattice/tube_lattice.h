// Fills a closed tube with lattice nodes: shell nodes on the surface, interior by transfinite interpolation.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// The lattice of a closed tube-like or box-like body. Slices lie at constant v, evenly along the body; the
// nodes of a ring are spaced by arc length, since spacing by angle gives slender cells and twice the
// substeps; the two end slices lie on the caps. Where cells fold so, as of a body that is hollow about a
// pole, the caps reach to the shoulders of the body, and the nodes inside follow the whole hull and are drawn
// apart (unfolding.h). Refused: a surface that is no closed tube, counts below 2, cells that fold all the
// same. `watch` is told how a feature map comes along.
Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch = {});

}  // namespace spoonbill
