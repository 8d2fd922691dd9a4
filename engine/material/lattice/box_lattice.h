// Fills a solid of triangles with lattice nodes: a regular grid over its bounds, each cell by the share of it
// that is inside the solid.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// A cell that holds any of the surface counts as filled by at least this share: the nodes of a smaller sliver
// would be so light and so weakly held that a contact on its surface would sink in. One that holds nothing
// counts by a share that moves nothing but keeps its nodes together. Mass and stiffness of a cell follow its
// share alike, so that no share makes the lattice any faster (the fastest frequency of what is put together
// is at most that of the fastest part, Irons and Treharne 1971); void cells that follow along are those of
// the finite cell method (Parvizian, Duester and Rank 2007).
inline constexpr double least_filled_share = 0.1;
inline constexpr double void_share = 1e-3;

// A box of nodes over the bounds, edges along x, y and z. Shares come from `inside`, 5 x 5 x 5 points a cell,
// and are scaled together so that the lattice's volume is `volume_m3`; `skin_m` are the points that shall be
// embedded. Refused: a box too flat for cells.
Result<LatticeMesh> box_lattice(const ShellDistance& inside, double volume_m3,
                                std::span<const Vector3> skin_m, std::array<int, 3> counts);

// A point in such a lattice at rest, of the cell that holds it or that it is nearest to.
CellPoint point_in_box(const LatticeMesh& box, const Vector3& point_m);
EmbeddedPoint embed_in_box(const LatticeMesh& box, const Vector3& point_m);

}  // namespace spoonbill
