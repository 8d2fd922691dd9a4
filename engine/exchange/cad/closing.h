// Surfaces that meet themselves made periodic: CAD files hold them open, with a seam.
#pragma once

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// The same surface, periodic in that direction, where its two edges coincide to `tolerance_m`; the surface as
// it is where they do not, or where an edge is a single point. Its seam is as smooth as the surface is there:
// as many of the seam's knots go as can without moving a control point of the open form by more than the
// tolerance. `surface` must be clamped in that direction.
Surface closed_where_it_meets(const Surface& surface, Direction direction, double tolerance_m);

// Makes the points of an edge that is one point to `tolerance_m` exactly that, in either direction.
void close_poles(Surface& surface, double tolerance_m);

struct ClosedExactly {
  Surface surface;
  double moved_m = 0.0;  // the farthest of samples of it
};

// What find_closing() calls a solid with its seams periodic and its poles points; anything else, and what
// cannot be made so within its tolerance, as it is.
ClosedExactly closed_exactly(const Surface& surface);

// The parameters at which a spline of as many control points is interpolated well: the mean of the inner
// knots that each basis function reaches (Greville 1964), brought into the domain.
std::vector<double> greville_parameters(const KnotVector& knots);

}  // namespace spoonbill
