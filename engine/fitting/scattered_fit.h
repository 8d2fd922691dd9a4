// Sparse least-squares fit of a surface to scattered points with known parameters. The blending matrix has
// one row per point (Eq. 4 of Pungotra et al. 2013); a fairness term determines the surface where there are
// no points.
#pragma once

#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Knots of the surface to fit, and the ends of v whose control points coincide in a pole.
struct SurfaceStructure {
  KnotVector u, v;
  bool pole_at_start = false, pole_at_end = false;
};

// Points to fit, with parameters and weights of the same length. Points with a NaN parameter are skipped.
//
// The fit minimises the weighted squared distances at the parameters plus the thin-plate energy of each span:
//   sum w |S(u, v) - p|^2
//     + mean(w) sum over spans f [(|S_uu| du^2)^2 + 2 (|S_uv| du dv)^2 + (|S_vv| dv^2)^2]
// A span is a rectangle of (u, v) between successive knots, with the sides du and dv; mean(w) is the sum of
// all weights divided by the number of spans. The fairness f has one value for each span; v varies fastest.
// Normal equations are accurate enough for scans; they stay definite if f is above 1e-9.
//
// Each pole is pulled to the mean of the ring of control points next to it, and the rings around it are
// pulled to ellipses, as on a surface with a tangent plane at the pole. An elliptic ring satisfies
//   S = a + b cos 2 pi u + c sin 2 pi u    and    S_u + S_uuu / (2 pi)^2 = 0.
// A Fourier component of order n around the pole is penalised by the square of n^3 - n.
struct ScatteredData {
  std::span<const Vector3> points_m;
  std::span<const Vector2> uv;
  std::span<const double> weights;
};

// Fits one surface. Fails if all weights are zero or the system is not definite.
Result<Surface> fit_scattered(const SurfaceStructure& structure, const ScatteredData& data,
                              std::span<const double> fairness);

// Fits one surface for each factor by which the fairness is multiplied, at little more than the cost of one
// fit.
Result<std::vector<Surface>> fit_scattered_family(const SurfaceStructure& structure,
                                                  const ScatteredData& data, std::span<const double> fairness,
                                                  std::span<const double> factors);

// Returns the number of spans between distinct knots.
std::size_t span_count(const KnotVector& knots);

// Inserts knots in one direction (0: u, 1: v) until there are `count` control points, each time halving the
// span with the largest sum of weighted squared errors. Each half gets a quarter of the span's sum. At first,
// 30 % of the total error is added to the sums, in proportion to the lengths of the spans, so that uniform
// errors lead to even refinement. Spans shorter than a quarter of the mean are not halved.
KnotVector refine_knots(const KnotVector& knots, int direction, int count, std::span<const Vector2> uv,
                        std::span<const double> weighted_squares);

}  // namespace spoonbill
