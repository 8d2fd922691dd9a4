#include <gtest/gtest.h>

#include "engine/bspline/basis.h"
#include "engine/bspline/surface.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

double longest_by_u(const Surface& surface) {
  const int columns = surface.v.control_point_count();
  return DerivativeBound(surface.u).longest(ControlLines<double>{surface.net.x.data(), surface.net.y.data(),
                                                                 surface.net.z.data(), columns, columns, 1});
}

double longest_by_v(const Surface& surface) {
  const int rows = surface.u.control_point_count(), columns = surface.v.control_point_count();
  return DerivativeBound(surface.v).longest(ControlLines<double>{surface.net.x.data(), surface.net.y.data(),
                                                                 surface.net.z.data(), 1, rows, columns});
}

TEST(DerivativeBound, HoldsEveryDerivative) {
  Random random(71);
  for (int repeat = 0; repeat < 500; ++repeat) {
    const Surface surface = random_surface(random);
    // The factor covers the rounding of a sum of ten terms, each up to the magnitude of the bound.
    constexpr double above_rounding = 1.0 + 1e-12;
    const double longest_u = longest_by_u(surface) * above_rounding;
    const double longest_v = longest_by_v(surface) * above_rounding;
    const std::vector<double> v_parameters = random_parameters(random, surface.v, 12);
    for (const double u : random_parameters(random, surface.u, 12)) {
      for (const double v : v_parameters) {
        const SurfacePoint point = evaluate(surface, u, v);
        EXPECT_LE(point.du.norm() * length_of(surface.u), longest_u) << repeat;
        EXPECT_LE(point.dv.norm() * length_of(surface.v), longest_v) << repeat;
      }
    }
  }
}

// At a clamped end, the curve's derivative equals the first control point of the derivative curve.
TEST(DerivativeBound, IsReachedAtAClampedEnd) {
  const KnotVector knots = KnotVector::open(3, {2, 2, 2, 2, 3, 5, 5, 5, 5}).value();
  const std::vector<double> x = {0, 6, 7, 8, 8}, zero(5, 0.0);
  const double longest =
      DerivativeBound(knots).longest(ControlLines<double>{x.data(), zero.data(), zero.data(), 1, 1, 5});
  // The first control point of the derivative is 3 * 6 / (3 - 2) = 18. The bound is for a domain scaled from
  // length 3 to length 1, so it is three times as large.
  EXPECT_DOUBLE_EQ(longest, 54.0);
}

}  // namespace
}  // namespace spoonbill
