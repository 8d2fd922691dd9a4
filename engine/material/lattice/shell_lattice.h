// Lattices of thin shells. The nodes are in layers between a surface and its offset by the thickness.
#pragma once

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Returns the lattice of a shell. The surface is the outer face of the shell: the face that is shaped,
// touched, drawn and exported. Its normals point along du x dv, and the material is behind it, against the
// normals, to a depth of the thickness.
//
// i runs along u, j from the surface through the thickness, k along v. If only v is periodic, i runs along v
// and k along u. A surface open in both directions makes a sheet. A surface periodic in one direction makes a
// closed ring (LatticeMesh::closed), or a bowl if it is periodic in u and has a pole at one end of v. A bowl
// is covered by a square grid. Nodes are spaced by arc length.
//
// Cells have straight edges; their fractions correct the volume of the lattice to that between the surface
// and its offset. Fails on a thickness out of range or beyond the radius of curvature, surfaces periodic in
// both directions or with more than one pole, a requested feature map, and counts below 2.
Result<LatticeMesh> shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request);

}  // namespace spoonbill
