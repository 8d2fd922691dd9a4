// Thin shells filled with lattice nodes: layers between a surface and its offset by the thickness.
#pragma once

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Returns the lattice of a shell. The surface is the face that its normals (along du x dv) point out of: the
// one that is shaped, touched, drawn and exported. The material is behind it, against the normals, to a
// depth of the thickness.
//
// i runs along u, j from the surface through the thickness, k along v. If only v is periodic, i runs along
// v and k along u. A surface open in both directions makes a sheet; one periodic in one direction makes a
// closed ring (LatticeMesh::closed). One periodic in u with a pole at one end of v makes a bowl, covered by
// a square grid. Nodes are spaced by arc length.
//
// Cells have straight edges; their fractions correct the volume of the lattice to that between the surface
// and its offset. Fails on a thickness out of range or beyond the radius of curvature, surfaces periodic in
// both directions or with more than one pole, and counts below 2.
Result<LatticeMesh> shell_lattice(const Surface& surface, double thickness_m, const LatticeRequest& request);

}  // namespace spoonbill
