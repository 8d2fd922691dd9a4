// The same surface over another knot vector: exactly over a finer one (more knots, a higher degree, a part of
// the domain), or as near as a coarser one allows, with a bound of the deviation. Pure functions outside the
// tick; any thread.
#pragma once

#include <Eigen/Core>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_insertion.h"
#include "engine/bspline/knot_vectors.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Over knots that hold every knot of the surface within their domain, each as many times more often as the
// degree is higher (elevated, knot_union, clamped_part make such); exact but for rounding. An open target may
// be a part of a periodic direction. Refused: knots that leave one of the surface's out, which is named.
// A control point is the blossom of a polynomial piece in its support at its inner knots (Ramshaw 1989), that
// of a higher degree the mean over the choices of so many of them.
Result<Surface> over_finer_knots(const Surface& surface, Direction direction, const KnotVector& finer);

// `deviation_m` is never passed: the largest distance between the control points of both over a common knot
// vector, and surfaces lie in the hull of those.
struct Approximation {
  Surface surface;
  double deviation_m = 0.0;
};

// Over any knots of the same domain, by least squares; clamped ends are kept. A periodic surface may become
// an open one, and an open one whose edges meet a periodic one. Refused: another domain.
Result<Approximation> over_coarser_knots(const Surface& surface, Direction direction,
                                         const KnotVector& coarser);

// The same with pieces of `first` halved where the deviation asks, until it is at most `tolerance_m`. Refused
// where `largest_count` control points do not reach it; the message tells what they reach. Stopped by the
// progress.
Result<Approximation> approximated(const Surface& surface, Direction direction, const KnotVector& first,
                                   double tolerance_m, int largest_count, const Progress& progress = {});

// As few knots as the tolerance allows to remove, the cheapest first. Ends and degree stay. Stopped by the
// progress.
Result<Approximation> without_spare_knots(const Surface& surface, Direction direction, double tolerance_m,
                                          const Progress& progress = {});

// The knot vector of a direction.
const KnotVector& knots_along(const Surface& surface, Direction direction);

// Over `knots`, with control points along the direction that are weighted sums of the old ones: a row of
// weights for each new one, a column for each old one. Summed in order, for the same bits everywhere.
Surface mixed_along(const Surface& surface, Direction direction, const Eigen::MatrixXd& weights,
                    const KnotVector& knots);

}  // namespace spoonbill
