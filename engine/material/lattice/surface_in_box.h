// A box of lattice cells about a closed surface that no block of cells can be bent into: bowls, rings.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Cells count by the share of them that is inside (box_lattice.h); what is thinner than a cell is stiffer
// than its material in bending. Counts are along x, y and z. Each node of the
// body and each cell tells where in the body it lies: by the sample of the surface nearest to it, and how
// deep. A feature map in the request does nothing. Refused: counts below 2, a body so flat that its volume
// over half its area is below a ten-thousandth of its size.
Result<LatticeMesh> surface_in_box(const Surface& surface, const LatticeRequest& request);

}  // namespace spoonbill
