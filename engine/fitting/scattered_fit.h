// Least-squares fit of a surface to scattered points whose parameters are known: the blending matrix of all
// points (Eq. 4 of Pungotra et al. 2013, a row a point), its normal equations kept sparse, and a fairness
// that decides where there are no points.
#pragma once

#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {

// Which surfaces are asked for: the knots, and whether the control points of an end of v are one (a pole).
struct SurfaceStructure {
  KnotVector u, v;
  bool pole_at_start = false, pole_at_end = false;
};

// Minimises the weighted squares of the distances between points and surface at their parameters, plus the
// thin-plate energy of every span, measured in its own length:
//   sum w |S(u, v) - p|^2 + mean(w) sum over spans f (|S_uu| du^2)^2 + 2 (|S_uv| du dv)^2 + (|S_vv| dv^2)^2
// where mean(w) is the points' weight for each span, du, dv are the span's sides and f its fairness
// (u-major, one for each pair of spans). The squared conditioning of normal equations is harmless at the
// accuracy of scans; fairness above 1e-9 keeps them definite. A pole is besides held in the mean of the ring
// next to it, and the rings about it near ellipses, as on a surface with a tangent plane there: a ring
//   S = a + b cos 2 pi u + c sin 2 pi u    has    S_u + S_uuu / (2 pi)^2 = 0,
// and what turns n times around is held by the square of n^3 - n. Points with a NaN parameter are passed
// over.
struct ScatteredData {
  std::span<const Vector3> points_m;
  std::span<const Vector2> uv;
  std::span<const double> weights;
};

// Refused: no weight at all, a system that is not definite.
Result<Surface> fit_scattered(const SurfaceStructure& structure, const ScatteredData& data,
                              std::span<const double> fairness);

// The same with the fairness times each factor, at little more than the cost of one.
Result<std::vector<Surface>> fit_scattered_at(const SurfaceStructure& structure, const ScatteredData& data,
                                              std::span<const double> fairness,
                                              std::span<const double> factors);

// The spans of a direction: pairs of distinct knots.
std::size_t span_count(const KnotVector& knots);

}  // namespace spoonbill
