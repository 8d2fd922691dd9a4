#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/bspline/grid.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

std::vector<double> twice_as_many(const KnotVector& knots) {
  const int count = 2 * knots.control_point_count() + 3;
  return knots.is_periodic() ? uniform_parameters_without_seam(knots, count)
                             : uniform_parameters(knots, count);
}

TEST(GridFit, GivesBackTheSurfaceThatWasSampled) {
  Random random(51);
  for (const int degree : {1, 2, 3, 4, 5}) {
    const Surface surface = random_surface(random, KnotVector::clamped_uniform(degree, 9).value(),
                                           KnotVector::periodic_uniform(degree, 8).value());
    const PointGrid points = sample_grid_points(surface, twice_as_many(surface.u), twice_as_many(surface.v));
    const auto fit = fit_grid(surface.u, surface.v, points);
    ASSERT_TRUE(fit.ok()) << fit.error().message;
    // With twice as many samples as control points, the condition number stays below 20 for these degrees.
    for (std::size_t k = 0; k < surface.net.size(); ++k) {
      EXPECT_NEAR(fit->net.y[k], surface.net.y[k], 1e-13);
    }
    EXPECT_LT(largest_deviation_m(fit.value(), points), 1e-13);
  }
}

TEST(GridFit, MeetsEndsExactly) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{uniform_parameters(knots, 30), uniform_parameters(knots, 30), {}};
  for (const double u : points.u) {
    for (const double v : points.v) points.points_m.emplace_back(u, v, std::sin(9.0 * u) * std::cos(7.0 * v));
  }
  const auto fit = fit_grid(knots, knots, points, {true, true, true, true});
  ASSERT_TRUE(fit.ok());
  for (const double u : {0.0, 1.0}) {
    for (const double v : {0.0, 1.0}) {
      EXPECT_NEAR(position(fit.value(), u, v).z(), std::sin(9.0 * u) * std::cos(7.0 * v), 1e-14);
    }
  }
  const auto loose = fit_grid(knots, knots, points);
  EXPECT_GT(std::abs(position(loose.value(), 1.0, 1.0).z() - std::sin(9.0) * std::cos(7.0)), 1e-4);
}

TEST(GridFit, RefusesPointsThatDoNotFit) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{uniform_parameters(knots, 12), uniform_parameters(knots, 12), {}};
  EXPECT_FALSE(fit_grid(knots, knots, points).ok());
  points.points_m.assign(144, Vector3::Zero());
  EXPECT_TRUE(fit_grid(knots, knots, points).ok());
  points.points_m[5].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_grid(knots, knots, points).ok());
  const PointGrid few{uniform_parameters(knots, 5), uniform_parameters(knots, 12),
                      std::vector<Vector3>(60, Vector3::Zero())};
  EXPECT_FALSE(fit_grid(knots, knots, few).ok());
}

}  // namespace
}  // namespace spoonbill
