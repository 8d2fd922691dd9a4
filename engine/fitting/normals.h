// Normals of clouds and orientation of surfaces: consistent signs, estimates from neighbours, outward sides.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Returns one flag per normal, true if the normal must be flipped so that all normals agree along the
// surface. Normals at both ends of a chord should be mirror images in its bisecting plane; signs are
// propagated along the minimum spanning tree of this measure (Hoppe et al. 1992). Each component keeps the
// orientation of the majority of its normals if the majority is at least three quarters; otherwise its
// normals point away from its centre. Zero normals are ignored.
std::vector<bool> orient_consistently(const std::vector<Vector3>& points_m,
                                      const std::vector<Vector3>& normals,
                                      const std::vector<NodePair>& pairs);

// Returns one flag per node, true if its normal must be flipped; all flags are false if the normals already
// agree. Neighbours with opposite normals disagree if they are side by side along the surface; if one is
// behind the other, they belong to the two faces of a wall.
std::vector<bool> find_inconsistent_normals(const Scan& nodes);

// Estimates a normal for each parameter pair in `uv`. The pairs belong to the points in order; any pairs
// beyond these get zero. Normals are perpendicular to the local plane of the nodes and oriented consistently.
// In each component they agree with the surface's normals at most points. A normal is zero where the nodes
// have no clear plane. All normals of a component are zero if more than a fifth of them oppose the surface's
// normals, as where both faces of a thin wall are mixed.
std::vector<Vector3> estimate_normals(const FitPoints& points, const Surface& surface,
                                      const std::vector<Vector2>& uv);

// Returns true if the normals of a sheet or a tube (periodic in u) point inwards: towards a tube's axis, or
// into a sheet's hollow side. Nearly flat sheets should face +z; upright ones +y, then +x.
bool is_inside_out(const Surface& surface);

}  // namespace spoonbill
