#include "engine/study/curvature_range.h"

#include <cmath>
#include <limits>

#include "engine/study/piece_sampling.h"

namespace spoonbill {

namespace {

constexpr int parts = 3;
// Of the lengths of du and dv: below, their product is rounding.
constexpr double least_product = 1e-9;

}  // namespace

// From the first and second fundamental form (do Carmo 1976, section 3.3).
std::optional<PrincipalCurvatures> principal_curvatures(const SurfacePoint& point) {
  const Vector3 product = point.du.cross(point.dv);
  const double area = product.norm();
  if (!(area > least_product * point.du.norm() * point.dv.norm())) return std::nullopt;
  const Vector3 inward = -product / area;
  const double E = point.du.dot(point.du), F = point.du.dot(point.dv);
  const double L = point.duu.dot(inward), M = point.duv.dot(inward), N = point.dvv.dot(inward);
  // In an orthonormal frame of the tangent plane, so that slender parameters lose no digits.
  const double along = std::sqrt(E), across = area / along;
  const double a = L / E, b = (M - F / E * L) / (along * across);
  const double c = (N - 2.0 * F / E * M + F / E * F / E * L) / (across * across);
  const double mean = 0.5 * (a + c), spread = std::hypot(0.5 * (a - c), b);
  return PrincipalCurvatures{mean - spread, mean + spread};
}

CurvatureRange curvature_range(const Surface& surface) {
  const std::vector<PieceCell> cells = piece_cells(surface, parts);
  const auto extreme = [&](bool largest) {
    const ParameterPlace place = least_place(cells, [&](double u, double v) {
      const auto found = principal_curvatures(evaluate(surface, u, v));
      if (!found) return std::numeric_limits<double>::infinity();
      return largest ? -found->largest : found->smallest;
    });
    return CurvaturePlace{largest ? -place.value : place.value, place.u, place.v,
                          position(surface, place.u, place.v)};
  };
  return {extreme(false), extreme(true)};
}

double bending_measure(const Surface& surface) {
  double sum = 0.0;
  for (const PieceCell& cell : piece_cells(surface, 2 * parts)) {
    // The midpoint rule: the integrand is not smooth at knots and poles.
    const SurfacePoint point = evaluate(surface, cell.middle_u(), cell.middle_v());
    const auto found = principal_curvatures(point);
    if (!found) continue;
    const double squares = found->smallest * found->smallest + found->largest * found->largest;
    sum += squares * point.du.cross(point.dv).norm() * (cell.u1 - cell.u0) * (cell.v1 - cell.v0);
  }
  return sum;
}

}  // namespace spoonbill
