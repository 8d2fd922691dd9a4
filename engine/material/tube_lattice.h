// Fills a closed tube with lattice nodes: shell nodes on the surface, interior by transfinite interpolation.
#pragma once

#include <array>
#include <optional>

#include "engine/bspline/surface.h"
#include "engine/material/lattice_mesh.h"
#include "engine/result.h"

namespace spoonbill {

// How many nodes a body gets across (first, second) and along (third) itself: given, or counted out so that
// cells are near-cubic and at most `node_budget` nodes are spent.
struct LatticeRequest {
  int node_budget = 2000;
  std::optional<std::array<int, 3>> counts;  // each at least 2
};

// Whether the surface is a closed tube: periodic in u, a single point (a pole) at both ends of v, normals
// outward. The message says which of these fails.
Status check_closed_tube(const Surface& surface);

// The lattice of a closed tube-like or box-like body. Slices lie at constant v, evenly along the body; the
// nodes of a ring are spaced by arc length, since spacing by angle gives slender cells and twice the
// substeps; the two end slices lie on the caps. Refused: a surface that is no closed tube, counts below 2,
// folded cells.
Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request);

}  // namespace spoonbill
