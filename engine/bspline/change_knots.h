// Conversion of surfaces to other knot vectors. It is exact if the new knots are finer (more knots, a higher
// degree, a part of the domain). If they are coarser, it is approximate, and the deviation has a known bound.
// All functions are pure, may be called from any thread, and are too slow for a tick.
#pragma once

#include <Eigen/Core>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Converts a surface exactly, except for rounding, to finer knots. Each of the surface's knots in the domain
// of `finer` must also be in `finer`, with a multiplicity raised by the difference of the degrees;
// elevate_degree(), knot_union() and clamped_part() make such knots. If `finer` is open, it may cover a part
// of a periodic direction. Each new control point is a value of the blossom of a polynomial piece (Ramshaw
// 1989). The error for missing knots names one of them.
Result<Surface> convert_to_finer_knots(const Surface& surface, Direction direction, const KnotVector& finer);

// A surface that approximates another. `deviation_m` bounds the distance between the two surfaces. It is the
// largest distance between their control points over a common knot vector; the distance between the surfaces
// cannot be larger, because of the convex hull property.
struct Approximation {
  Surface surface;
  double deviation_m = 0.0;
};

// Fits the surface by least squares over the knots `coarser`, and interpolates it at clamped ends. A periodic
// surface may become open; an open surface whose edges meet may become periodic. Refuses knots with a
// different domain.
Result<Approximation> fit_coarser_knots(const Surface& surface, Direction direction,
                                        const KnotVector& coarser);

// Fits a surface over the knots `first`, then halves the polynomial pieces in which the deviation exceeds
// `tolerance_m`, and repeats the fit until the deviation is within the tolerance everywhere. Fails if
// `largest_count` control points do not suffice; the message states the deviation reached. `progress` can
// cancel the fit.
Result<Approximation> approximated(const Surface& surface, Direction direction, const KnotVector& first,
                                   double tolerance_m, int largest_count, const Progress& progress = {});

// Removes knots as long as the deviation stays within the tolerance, starting with those whose removal
// changes the surface least. Keeps the degree and the knots at the ends. `progress` can cancel the removal.
Result<Approximation> remove_spare_knots(const Surface& surface, Direction direction, double tolerance_m,
                                         const Progress& progress = {});

// Returns a surface over `knots` whose control points along the direction are weighted sums of the old ones.
// `weights` has a row for each new control point and a column for each old one. The order of summation is
// fixed, so that the result has the same bits on every machine.
Surface combine_along(const Surface& surface, Direction direction, const Eigen::MatrixXd& weights,
                      const KnotVector& knots);

// Removes `copies` copies of the knot at the parameter by least squares. The result is exact if the surface
// is smooth enough at the knot. Refuses a parameter without a knot, more copies than there are, the ends of
// an open direction, and the removal of all copies at the seam of a periodic direction.
Result<Approximation> remove_knot(const Surface& surface, Direction direction, double parameter, int copies);

}  // namespace spoonbill
