#include "engine/inspection/curvature_range.h"

#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/inspection/piece_sampling.h"

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
  const double e = point.du.dot(point.du), f = point.du.dot(point.dv);
  const double l = point.duu.dot(inward), m = point.duv.dot(inward), n = point.dvv.dot(inward);
  // In an orthonormal frame of the tangent plane, so that slender parameters lose no digits.
  const double along = std::sqrt(e), across = area / along;
  const double a = l / e, b = (m - f / e * l) / (along * across);
  const double c = (n - 2.0 * f / e * m + f / e * f / e * l) / (across * across);
  const double mean = 0.5 * (a + c), spread = std::hypot(0.5 * (a - c), b);
  return PrincipalCurvatures{mean - spread, mean + spread};
}

CurvatureRange curvature_range(const Surface& surface, const TrimmedArea& area, const Progress& progress) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const std::vector<PieceCell> cells = piece_cells(surface, parts);
  const auto extreme = [&](bool largest) {
    const auto value = [&](double u, double v) {
      constexpr double none = std::numeric_limits<double>::infinity();
      if (!area.contains(u, v)) return none;
      const auto found = principal_curvatures(evaluate(surface, u, v));
      if (!found) return none;
      return largest ? -found->largest : found->smallest;
    };
    const ParameterPlace place =
        least_place(cells, value, largest ? progress.part(0.5, 1.0) : progress.part(0.0, 0.5));
    return CurvaturePlace{largest ? -place.value : place.value, place.u, place.v,
                          position(surface, place.u, place.v)};
  };
  const CurvaturePlace smallest = extreme(false);
  return {smallest, extreme(true)};
}

double bending_measure(const Surface& surface, const TrimmedArea& area) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  double sum = 0.0;
  for (const PieceCell& cell : piece_cells(surface, 2 * parts)) {
    if (!area.contains(cell.middle_u(), cell.middle_v())) continue;
    // The midpoint rule: the integrand is not smooth at knots, poles and trims.
    const SurfacePoint point = evaluate(surface, cell.middle_u(), cell.middle_v());
    const auto found = principal_curvatures(point);
    if (!found) continue;
    const double squares = found->smallest * found->smallest + found->largest * found->largest;
    sum += squares * point.du.cross(point.dv).norm() * (cell.u1 - cell.u0) * (cell.v1 - cell.v0);
  }
  return sum;
}

}  // namespace spoonbill
