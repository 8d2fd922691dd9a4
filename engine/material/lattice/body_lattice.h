// Lattices of bodies. The lattice of a shell consists of layers of cells. The lattice of a solid is a block
// of cells that is bent into the body, or a box of cells around the body.
#pragma once

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/body.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Returns the frame of a rigid body: a single cell around its surface or mesh, whose nodes move with the
// body's pose. Points of the body are attached to the frame like points of a deformable body to its lattice.
// A trilinear cell reproduces every rigid motion exactly, so they move rigidly. The frame's nodes count as
// outside the body. Fails if all control points or vertices coincide.
Result<LatticeMesh> rigid_frame(const Body& body);

// Returns the lattice of a body of a scene at rest, solid or shell, or the frame of a fixed or rigid body,
// which must also be a closed solid or a shell, or have a mesh. Fails if solid_lattice() or shell_lattice()
// fails. If the body requests a feature map, `watch` receives the progress
// of order_by_feature_map().
Result<LatticeMesh> make_body_lattice(const Body& body, const FeatureMapWatch& watch = {});

// Returns the lattice of a closed body: that of tube_lattice() if the body is a tube, no cell folds and the
// request is not for a box, otherwise that of surface_in_box(). Fails if the surface does not pass
// check_closed(), if the body is too flat for cells, and on counts below 2. `watch` receives the progress of
// order_by_feature_map().
Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch = {});

// Returns the lattice of a closed tube-like or box-like body. Slices of nodes are at constant v, evenly
// spaced along the body. The nodes around a slice are spaced by arc length; spacing by angle would give
// slender cells and twice as many substeps. The nodes of the two end slices are on the caps of the tube.
//
// If cells fold, as in a body that is hollow at a pole, further attempts use larger caps, which reach at
// least to the shoulders (shoulder_rims()). These attempts interpolate the interior nodes from the whole hull
// and then unfold the cells. Fails on a surface that is not a closed tube, counts below 2, and cells that
// remain folded. `watch` receives the progress of order_by_feature_map().
Result<LatticeMesh> tube_lattice(const Surface& surface, const LatticeRequest& request,
                                 const FeatureMapWatch& watch = {});

}  // namespace spoonbill
