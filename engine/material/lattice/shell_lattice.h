// Fills a thin shell with lattice nodes: layers between a surface and its offset by the thickness.
#pragma once

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// The surface is one face of the shell, that which its normals (along du x dv) point out of: what a designer
// shapes is then what the tool touches, what is drawn and what is exported. The material lies behind it, to
// the thickness along the normals.
//
// i runs along u, j through the thickness from the surface on, k along v; where v alone is periodic, i runs
// along v and k along u. A surface that is open both ways makes a sheet, one that is periodic in one
// direction a ring that is closed (LatticeMesh::closed), and one that is periodic in u with a pole at one end
// of v a bowl, over which a square grid is laid as a cloth over a disc. Nodes are spaced by arc length.
//
// Cells are made of chords; their shares are such that the lattice has the volume of the shell between the
// surface and its offset. Refused: a thickness out of range or beyond the surface's radius of curvature,
// surfaces periodic both ways or with more than one pole, counts below 2.
Result<LatticeMesh> shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request);

}  // namespace spoonbill
