// Conversion of surfaces to other knot vectors: exact to finer ones (more knots, a higher degree, a part of
// the domain), approximate to coarser ones, with a bound of the deviation. Pure functions outside the tick;
// any thread may call them.
#pragma once

#include <Eigen/Core>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Converts a surface exactly, except for rounding, to finer knots. They must contain each of the surface's
// knots in the domain of `finer`, with its multiplicity raised by the difference of the degrees;
// elevate_degree(), knot_union() and clamped_part() make such knots. If `finer` is open, it may cover a part
// of a periodic direction. Each control point is the blossom of a polynomial piece in its support (Ramshaw
// 1989). The error for missing knots names one of them.
Result<Surface> convert_to_finer_knots(const Surface& surface, Direction direction, const KnotVector& finer);

// An approximation. `deviation_m` bounds the distance between both surfaces: it is the largest distance of
// their control points over a common knot vector, and surfaces are in the convex hull of their control
// points.
struct Approximation {
  Surface surface;
  double deviation_m = 0.0;
};

// Fits a surface over any knots of the same domain by least squares and interpolates clamped ends. A periodic
// surface may become open; an open surface whose edges meet may become periodic. Refuses knots with a
// different domain.
Result<Approximation> fit_coarser_knots(const Surface& surface, Direction direction,
                                        const KnotVector& coarser);

// Fits a surface, first over the knots `first`, then with pieces halved wherever the deviation exceeds
// `tolerance_m`, until the deviation is within the tolerance everywhere. Fails if `largest_count` control
// points do not suffice; the message states the deviation reached. `progress` can cancel the fit.
Result<Approximation> approximated(const Surface& surface, Direction direction, const KnotVector& first,
                                   double tolerance_m, int largest_count, const Progress& progress = {});

// Removes knots, cheapest first, as long as the deviation stays within the tolerance. Keeps the degree and
// the knots at the ends. `progress` can cancel the removal.
Result<Approximation> remove_spare_knots(const Surface& surface, Direction direction, double tolerance_m,
                                         const Progress& progress = {});

// Returns a surface over `knots` whose control points along the direction are weighted sums of the old ones.
// `weights` has a row for each new control point and a column for each old one. The order of summation is
// fixed, so that the result has the same bits on every machine.
Surface combine_along(const Surface& surface, Direction direction, const Eigen::MatrixXd& weights,
                      const KnotVector& knots);

// Removes `copies` copies of the knot at the parameter by least squares; exact where the surface is smooth
// enough there. Refuses a parameter without a knot, more copies than there are, the ends of an open
// direction, and all copies at the seam of a periodic one.
Result<Approximation> remove_knot(const Surface& surface, Direction direction, double parameter, int copies);

}  // namespace spoonbill
