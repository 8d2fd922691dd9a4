// Searches for the nearest and the deepest points of two surfaces, by Newton's method on the exact surfaces.
// The searches are local: their results depend on the starting parameters. They allocate nothing.
#pragma once

#include <cstddef>

#include "engine/bspline/piece_basis.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/surface_contact.h"

namespace spoonbill {

// Parameters (u, v) on the first surface and (s, t) on the second.
struct PairParameters {
  double u = 0.0, v = 0.0, s = 0.0, t = 0.0;
};

// A point on each of two surfaces.
struct SurfacePair {
  PairParameters at;
  Vector3 first_m, second_m;
  double distance_m() const { return (first_m - second_m).norm(); }
};

// Finds a locally nearest pair of points by a damped Newton's method on half the squared distance. Parameters
// stay within the domains.
SurfacePair nearest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from);

// Limits of searches. They bound the time of a tick. A search that reaches one returns the best point found
// so far.
struct PolishBudget {
  int evaluations_left;  // number of surface points that all searches together may still evaluate
  // A search ends when the next step would decrease the distance by less than this, in metres.
  double least_gain_m = 1e-17;

  bool is_spent() const { return evaluations_left <= 0; }
};

// Largest number of surface points that a proximity search evaluates for the points of one surface.
// Evaluating so many takes about 50 ms. A sample near a smooth body needs about five evaluations; near a
// crumpled body, it would need thousands. When the number is used up, each remaining sample costs one
// evaluation.
inline constexpr int proximity_evaluation_limit = 1 << 17;
// PolishBudget::least_gain_m of a proximity search. At a distance of 0.1 mm, it leaves the nearest point
// within 15 nm, so that the normal is right to a millionth even where a radius is 15 mm.
inline constexpr double proximity_least_gain_m = 1e-12;
// Largest number of points that a proximity search finds on one surface.
inline constexpr std::size_t near_point_limit = 4096;

// A point on a surface with its parameters.
struct NearestPoint {
  double u, v;
  SurfacePoint at;
};
// Finds the locally nearest point of a surface, starting from the parameters u, v. If the search ends early,
// as at a pole, it starts once more beside the nearest pole. Without a budget, only the number of steps is
// limited.
NearestPoint nearest_point(const PiecewiseSurface& surface, const Vector3& point, double u, double v,
                           PolishBudget* budget = nullptr);

// Result of deepest_pair().
struct DeepestPair {
  SurfacePair pair;
  Vector3 normal = Vector3::UnitY();  // unit normal of the second surface, on the side given by `outside`
  double depth_m = 0.0;  // depth of the first surface's point behind the second; negative in front of it
};

// Returns the depth, in metres, of a point of the first surface behind the second; negative in front of it.
// The depth is measured at the second surface's nearest point, which is searched from `from`. `outside` is 1
// if the second surface's outward normal is du x dv, -1 if it is opposite.
double depth_behind(const PiecewiseSurface& first, const PiecewiseSurface& second, const PairParameters& from,
                    double outside);

// Finds the point of the first surface that is locally deepest behind the second. The depth is measured along
// the second surface's normal at its nearest point. Stops early once the depth exceeds `enough_m`. `outside`
// is 1 if the second surface's outward normal is du x dv, -1 if it is opposite.
//
// The depth is f = -d(A(u, v)), where A is the first surface and d the signed distance from the second
// surface B(s, t). Its gradient is -(A_u . n, A_v . n), with the normal n of B. Let I and II be the
// fundamental forms of B at the nearest point. When u changes, the parameters of the nearest point change by
// (I - d II)^-1 c per unit of u, with c = (A_u . B_s, A_u . B_t), and n rotates by -II times that change.
// Therefore
//   Hess d = -c^T I^-1 II (I - d II)^-1 c,   f_uu = -(A_uu . n) - Hess d.
DeepestPair deepest_pair(const PiecewiseSurface& first, const PiecewiseSurface& second, PairParameters from,
                         double outside, double enough_m, PolishBudget* budget = nullptr);

// One region in which two surfaces cross or touch.
struct PairContact {
  // The deepest point of one surface, and the point of the other surface that is nearest to it.
  SurfacePair pair;
  Vector3 normal;                // unit vector in the direction in which the first surface leaves the second
  double depth_m = 0.0;          // depth along the normal; 0 if the surfaces only touch
  ParameterRange first, second;  // parameter rectangles that contain the region
  Vector3 tangent_u, tangent_v;  // tangents_across() of the normal, on the first surface
};

// Sets the contact's tangents from its normal and the first surface.
inline void set_tangents(const PiecewiseSurface& first, PairContact& contact) {
  const PairParameters& at = contact.pair.at;
  const Tangents tangents = tangents_across(contact.normal, evaluate(first, at.u, at.v));
  contact.tangent_u = tangents.u;
  contact.tangent_v = tangents.v;
}

}  // namespace spoonbill
