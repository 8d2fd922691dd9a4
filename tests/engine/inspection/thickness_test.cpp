#include "engine/inspection/thickness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
// Each of the two walls is accurate to the fit's tolerance of 0.01 mm.
constexpr double tolerance_m = 2e-5;

TEST(Thickness, OfASphereIsItsDiameterEverywhere) {
  const Surface sphere = fitted(sphere_shape(0.04)).surface;
  const ThicknessSearch search(sphere);
  for (const double v : {0.1, 0.35, 0.5, 0.8}) {
    for (const double u : {0.0, 0.3, 0.77}) {
      const auto found = search.at(u, v);
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->thickness_m, 0.08, tolerance_m);
      EXPECT_LT((found->opposite_m - position(sphere, found->opposite_u, found->opposite_v)).norm(), 1e-9);
    }
  }
  EXPECT_NEAR(search.smallest()->thickness_m, 0.08, tolerance_m);
}

TEST(Thickness, OfAPlateAndADisc) {
  EXPECT_NEAR(ThicknessSearch(fitted(plate_shape({0.1, 0.06, 0.003, 0.006})).surface).smallest()->thickness_m,
              0.003, tolerance_m);
  EXPECT_NEAR(ThicknessSearch(fitted(cylinder_shape({0.04, 0.005, 0.001})).surface).smallest()->thickness_m,
              0.005, tolerance_m);
}

// The body is a ball of clay with a waist, a surface of revolution about y. It is thinnest at its waist.
TEST(Thickness, FindsAWaist) {
  ExactShape shape;
  shape.u.periodic = true;
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [](double u, double v) {
    const double ring = v <= 0.0 || v >= 1.0 ? 0.0 : std::sin(pi * v), height = -std::cos(pi * v);
    const double waist = 1.0 - 0.7 * std::exp(-20.0 * (height - 0.2) * (height - 0.2));
    return Vector3(0.02 * ring * waist * std::cos(2.0 * pi * u), 0.05 * height,
                   -0.02 * ring * waist * std::sin(2.0 * pi * u));
  };
  const Surface body = fitted(Result<ExactShape>(shape)).surface;
  // The smallest radius is found by a fine search of the profile.
  double least = 1.0, at_height = 0.0;
  for (int k = 1000; k < 9000; ++k) {
    const double v = k / 10000.0, radius = shape.at(0.0, v).x();
    if (radius < least && v > 0.4 && v < 0.7) {
      least = radius;
      at_height = shape.at(0.0, v).y();
    }
  }
  const ThicknessSearch search(body);
  const auto found = search.at(0.25, std::acos(-at_height / 0.05) / pi);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->thickness_m, 2.0 * least, 2e-5);
  EXPECT_LE(search.smallest()->thickness_m, 2.0 * least + tolerance_m);
}

TEST(Thickness, DoesNotHangOnWhichDirectionRunsAround) {
  const Surface tube = ellipsoid_tube(12, 16);
  Surface turned = transposed(tube);
  // Exchanging u and v flips the normals. Mirroring the surface makes them point outwards again.
  for (double& x : turned.net.x) x = -x;
  EXPECT_NEAR(ThicknessSearch(tube).smallest()->thickness_m, ThicknessSearch(turned).smallest()->thickness_m,
              1e-7);
}

}  // namespace
}  // namespace spoonbill
