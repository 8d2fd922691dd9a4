// Fits a surface to a whole grid of points through the blending matrices of both directions:
// P = A_u^+ M (A_v^+)^T (Eq. 5 of Pungotra et al. 2013, whose A_u^T A_u is not inverted here, because that
// squares the condition number). Runs outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/base/pose.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Point (i, j) belongs to the parameters u[i], v[j] and lies at index i * v.size() + j. The parameters
// increase strictly, within the domain; at least twice as many as control points keep the fit well
// conditioned.
struct PointGrid {
  std::vector<double> u, v;
  std::vector<Vector3> points_m;
};

// The ends that are met exactly instead of being fitted; each needs a clamped end and a parameter on it.
struct MetEnds {
  bool u_first = false, u_last = false, v_first = false, v_last = false;
};

// The surface with the least sum of squared distances at the parameters. Refused: points that are not as many
// as the parameters say or not finite, parameters that do not determine the control points.
Result<Surface> fit_grid(const KnotVector& u, const KnotVector& v, const PointGrid& points,
                         const MetEnds& met = {});

// The surface's points at the parameters u x v.
PointGrid point_grid(const Surface& surface, std::vector<double> u, std::vector<double> v);

// The largest distance between a point of the grid and the surface at its parameters.
double largest_deviation_m(const Surface& surface, const PointGrid& points);

}  // namespace spoonbill
