// Boxes of lattice cells about solids: about a solid of triangles, and about a closed surface into which no
// block of cells can be bent, such as a bowl or a ring.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Smallest fraction (LatticeMesh::cell_fractions) of a filled cell, before all fractions are scaled to the
// volume of the body. Nodes of smaller slivers would be so light and weakly attached that a contact on their
// surface would sink in.
//
// Mass and stiffness of a cell scale alike, so a small fraction does not raise the largest frequency of the
// lattice, which is at most the largest frequency of a single cell (Irons and Treharne 1971).
inline constexpr double min_filled_fraction = 0.1;

// Fraction of its volume to which a void cell counts as filled: too small to affect motions, but enough to
// keep its nodes together. Void cells follow the body as in the finite cell method (Parvizian, Duester and
// Rank 2007).
inline constexpr double void_fraction = 1e-3;

// Builds a box of nodes over the bounds of a solid, with edges along x, y and z. Fractions of cells are
// sampled from `inside` at 5 x 5 x 5 points per cell and scaled by one factor, so that the lattice's volume
// is `volume_m3`. `skin_m` are points of the surface; the cells that contain them count as filled. Fails on a
// box too flat for cells.
Result<LatticeMesh> box_lattice(const ShellDistance& inside, double volume_m3,
                                std::span<const Vector3> skin_m, std::array<int, 3> counts);

// point_in_box() and embed_in_box() return a point as a weighted sum of the nodes of the cell that contains
// it, or of the nearest cell, in an undeformed box.
CellPoint point_in_box(const LatticeMesh& box, const Vector3& point_m);
EmbeddedPoint embed_in_box(const LatticeMesh& box, const Vector3& point_m);

// Builds a box of cells about a closed surface. The fraction of a cell is its part inside the surface. Parts
// of the body thinner than a cell are too stiff in bending. Counts are along x, y and z. Nodes and cells get
// the body coordinates of the nearest sample of the surface, except that their depth is measured at the node
// or cell centre itself. A feature map in the request is ignored.
//
// Fails on counts below 2, and on a body whose volume divided by half its area is below a ten-thousandth of
// its size.
Result<LatticeMesh> surface_in_box(const Surface& surface, const LatticeRequest& request);

}  // namespace spoonbill
