// Normals of clouds and orientation of surfaces: consistent signs, estimates from neighbours, outward sides.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Returns a flag for each normal that must be flipped so that all agree along the surface. Normals at both
// ends of a chord should be mirror images in its bisecting plane; signs spread along the minimum spanning
// tree of that measure (Hoppe et al. 1992). Each component keeps the orientation of its majority if that is
// at least three quarters, otherwise it faces away from its centre. Zero normals are ignored.
std::vector<bool> orient_consistently(const std::vector<Vector3>& points_m,
                                      const std::vector<Vector3>& normals,
                                      const std::vector<NodePair>& pairs);

// Returns flags for the node normals to flip, all false where the normals agree already. Neighbours with
// opposite normals disagree if they are side by side along the surface; if one is behind the other, they are
// the two faces of a wall.
std::vector<bool> find_inconsistent_normals(const Scan& nodes);

// Estimates a normal for each parameter in `uv`, which belong to the points in order; any further ones get
// zero. Normals are perpendicular to the local plane of the nodes, oriented consistently, and follow the
// surface at the majority of each component. They are zero where the nodes have no clear plane, or where the
// surface opposes more than a fifth of the component, as where both faces of a thin wall are mixed.
std::vector<Vector3> estimate_normals(const FitPoints& points, const Surface& surface,
                                      const std::vector<Vector2>& uv);

// Returns true if the normals of a sheet or a tube (periodic in u) point inwards: towards a tube's axis, or
// into a sheet's hollow side. Nearly flat sheets should face +z; upright ones +y, then +x.
bool is_inside_out(const Surface& surface);

}  // namespace spoonbill
