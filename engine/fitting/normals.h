// Normals of clouds and orientation of surfaces: consistent signs, estimates from neighbours, outward sides.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Returns one flag per normal, true if the normal must be flipped so that all normals agree along the
// surface. At both ends of a chord, normals should be mirror images in the plane that bisects the chord.
// Signs are propagated along the minimum spanning tree of this measure (Hoppe et al. 1992). Each component
// keeps the orientation of the majority of its normals if that is at least three quarters; otherwise its
// normals point away from its centre. Zero normals are ignored.
std::vector<bool> orient_consistently(const std::vector<Vector3>& points_m,
                                      const std::vector<Vector3>& normals,
                                      const std::vector<NodePair>& pairs);

// Returns one flag per node, true if its normal must be flipped; all flags are false if the normals already
// agree. Neighbours with opposite normals disagree if they are side by side along the surface; if one is
// behind the other, they belong to the two faces of a wall.
std::vector<bool> find_inconsistent_normals(const Scan& nodes);

// Estimates a normal for each parameter pair in `uv`. The first pairs belong to the points in order; any
// further pairs get zero normals. A normal is perpendicular to the local plane of the nodes, or zero where
// the nodes have no clear plane. In each component, normals are oriented consistently and agree with the
// surface's normals at the majority of the points. All normals of a component are zero if more than a fifth
// of them oppose the surface's normals, which happens where both faces of a thin wall are mixed.
std::vector<Vector3> estimate_normals(const FitPoints& points, const Surface& surface,
                                      const std::vector<Vector2>& uv);

// Returns true if the normals of a sheet or a tube (periodic in u) point inwards: towards the tube's axis, or
// into the sheet's hollow side. A nearly flat sheet has no inside: its normals should point to +z or, if the
// sheet is upright, to +y or +x.
bool is_inside_out(const Surface& surface);

}  // namespace spoonbill
