#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/inspection/curvature.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// Returns the exact surface x = u, y = v, z = a u^2 + b v^2 over -1 to 1. The Bezier coefficients of t^2 are
// 1, -1, 1.
Surface paraboloid(double a, double b) {
  const KnotVector knots = KnotVector::open(2, {-1, -1, -1, 1, 1, 1}).value();
  ControlNet net(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto square = [](int k) { return k == 1 ? -1.0 : 1.0; };
      net.set_point(i, j, Vector3(i - 1.0, j - 1.0, a * square(i) + b * square(j)));
    }
  }
  return make_surface(knots, knots, net).value();
}

TEST(PrincipalCurvatures, AreThoseOfAParaboloid) {
  // At the vertex, the curvatures are -2 a and -2 b. The normals point up; a curvature is negative if the
  // surface is concave as seen from above.
  const auto vertex = compute_principal_curvatures(evaluate(paraboloid(0.7, -0.2), 0.0, 0.0));
  ASSERT_TRUE(vertex);
  EXPECT_NEAR(vertex->smallest, -1.4, 1e-14);
  EXPECT_NEAR(vertex->largest, 0.4, 1e-14);
  // Beside the vertex on the line v = 0, the curvatures are -2 a / root^3 along u and -2 b / root across it,
  // with root = (1 + 4 a^2 u^2)^(1/2).
  const auto beside = compute_principal_curvatures(evaluate(paraboloid(0.7, 0.2), 0.5, 0.0));
  const double root = std::sqrt(1.0 + 4.0 * 0.49 * 0.25);
  EXPECT_NEAR(beside->smallest, -1.4 / (root * root * root), 1e-14);
  EXPECT_NEAR(beside->largest, -0.4 / root, 1e-14);
}

TEST(PrincipalCurvatures, DoNotHangOnHowTheParametersRun) {
  const Surface straight = paraboloid(0.7, 0.2);
  // The parameters are sheared: u = s + 100 t. The points stay the same, and the derivatives change linearly.
  const SurfacePoint point = evaluate(straight, 0.3, -0.2);
  const auto plain = compute_principal_curvatures(point);
  SurfacePoint sheared = point;
  sheared.dv = 100.0 * point.du + point.dv;
  sheared.duv = 100.0 * point.duu + point.duv;
  sheared.dvv = 1e4 * point.duu + 200.0 * point.duv + point.dvv;
  const auto slanted = compute_principal_curvatures(sheared);
  ASSERT_TRUE(plain && slanted);
  EXPECT_NEAR(plain->smallest, slanted->smallest, 1e-10);
  EXPECT_NEAR(plain->largest, slanted->largest, 1e-10);
}

TEST(CurvatureRange, FindsAPeakBetweenSamples) {
  const CurvatureRange range = find_curvature_range(paraboloid(0.7, -0.2));
  EXPECT_NEAR(range.smallest.curvature_per_m, -1.4, 1e-6);
  EXPECT_NEAR(range.smallest.u, 0.0, 1e-3);
  EXPECT_NEAR(range.largest.curvature_per_m, 0.4, 1e-6);
  EXPECT_NEAR(range.largest.v, 0.0, 1e-3);
}

// The vertex, which is the sharpest point, is trimmed away. The rest is sharpest beside the cut.
TEST(CurvatureRange, OfWhatTrimsKeep) {
  const Surface whole = paraboloid(0.7, 0.0);
  const auto loop = polygon_loop(whole.u, whole.v, rectangle(0.5, -1.0, 1.0, 1.0));
  const CurvatureRange range =
      find_curvature_range(whole, TrimmedArea::make(whole.u, whole.v, {loop}).value());
  const double root = std::sqrt(1.0 + 4.0 * 0.49 * 0.25);
  EXPECT_NEAR(range.smallest.curvature_per_m, -1.4 / (root * root * root), 1e-3);
  EXPECT_GE(range.smallest.u, 0.5);
}

// Second derivatives of a cubic spline with n spans around are too small by the fraction (2 pi / n)^2 / 12,
// which is less than a thousandth here.
TEST(CurvatureRange, OfATorus) {
  ShapeFit fit;
  fit.control_counts = {{64, 64}};
  const Surface torus = fitted(torus_shape({0.04, 0.01}), fit).surface;
  const CurvatureRange range = find_curvature_range(torus);
  EXPECT_NEAR(range.largest.curvature_per_m, 100.0, 0.1);
  EXPECT_NEAR(range.smallest.curvature_per_m, -1.0 / 0.03, 0.05);
  const Vector3 inner = range.smallest.position_m;
  EXPECT_NEAR(std::hypot(inner.x(), inner.z()), 0.03, 1e-4);
}

TEST(CurvatureRange, OfASphereIsOneOverItsRadiusUpToThePoles) {
  ShapeFit fit;
  fit.control_counts = {{48, 64}};
  const Surface sphere = fitted(sphere_shape(0.04), fit).surface;
  const CurvatureRange range = find_curvature_range(sphere);
  EXPECT_NEAR(range.smallest.curvature_per_m, 25.0, 0.5);
  EXPECT_NEAR(range.largest.curvature_per_m, 25.0, 0.5);
  EXPECT_NEAR(compute_bending_energy(sphere), 8.0 * pi, 0.01 * 8.0 * pi);
}

TEST(CurvatureRange, OfAnEllipsoid) {
  constexpr double a = 0.03, b = 0.02, c = 0.05;  // c is along the axis through the poles
  ExactShape shape;
  shape.u.periodic = true;
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [](double u, double v) {
    const double ring = v <= 0.0 || v >= 1.0 ? 0.0 : std::sin(pi * v);
    return Vector3(a * ring * std::cos(2.0 * pi * u), -c * std::cos(pi * v),
                   -b * ring * std::sin(2.0 * pi * u));
  };
  ShapeFit fit;
  fit.control_counts = {{96, 96}};
  const Surface ellipsoid = fitted(Result<ExactShape>(shape), fit).surface;
  const CurvatureRange range = find_curvature_range(ellipsoid);
  // The curvature is largest at the ends of the longest axis, c / b^2, and smallest at the ends of the
  // shortest axis, b / c^2.
  EXPECT_NEAR(range.largest.curvature_per_m, c / (b * b), 0.01 * c / (b * b));
  EXPECT_NEAR(range.smallest.curvature_per_m, b / (c * c), 0.01 * b / (c * c));
  EXPECT_NEAR(std::abs(range.smallest.position_m.z()), b, 1e-4);
}

TEST(CurvatureRange, OfAFlatSheetIsNone) {
  const CurvatureRange range = find_curvature_range(paraboloid(0.0, 0.0));
  EXPECT_EQ(range.smallest.curvature_per_m, 0.0);
  EXPECT_EQ(range.largest.curvature_per_m, 0.0);
  EXPECT_EQ(compute_bending_energy(paraboloid(0.0, 0.0)), 0.0);
}

}  // namespace
}  // namespace spoonbill
