// The points of two surfaces that lie nearest, or deepest in one another, found by Newton's method from a
// first guess on the surfaces themselves. Local: what the guess leads to. Allocates nothing.
#pragma once

#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Parameters on the first surface, then on the second.
struct PairParameters {
  double u = 0.0, v = 0.0, s = 0.0, t = 0.0;
};

struct SurfacePair {
  PairParameters at;
  Vector3 first_m, second_m;
  double distance_m() const { return (first_m - second_m).norm(); }
};

// A damped Newton's method on half the squared distance; parameters stay within the domains.
SurfacePair nearest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from);

// The same for a point and a surface, from its parameters u, v.
struct NearestPoint {
  double u, v;
  SurfacePoint at;
};
NearestPoint nearest_point(const PiecewiseSurface& surface, const Vector3& point, double u, double v);

struct DeepestPair {
  SurfacePair pair;
  Vector3 normal = Vector3::UnitY();  // of the second surface, towards the side that `outside` says
  double depth_m = 0.0;               // of the first surface's point behind the second; below zero, before it
};

// How far a point of the first surface is behind the second, by the nearest point that `from` leads to; below
// zero, before it. See deepest_pair() for `outside`.
double depth_behind(const PiecewiseSurface& first, const PiecewiseSurface& second, const PairParameters& from,
                    double outside);

// The point of the first surface that lies farthest behind the second, along the normal of the second's
// nearest point; or any that lies deeper than `enough_m`. `outside` is 1 where that normal is du x dv, -1
// where it is the opposite.
//
// The depth is f = -d(A(u, v)) for the signed distance d to the second surface, with the gradient -A_u . n.
// With I and II the fundamental forms of the second surface at the nearest point, the parameters of that
// point follow a move c = (A_u . B_s, A_u . B_t) by (I - d II)^-1 c, and n turns by -II of that, so that
//   Hess d = -c^T I^-1 II (I - d II)^-1 c,   f_uu = -(A_uu . n) - Hess d.
DeepestPair deepest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from,
                         double outside, double enough_m);

}  // namespace spoonbill
