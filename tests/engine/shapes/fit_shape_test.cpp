#include "engine/shapes/fit_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

ExactShape wave(double bump) {
  ExactShape shape;
  shape.at = [=](double u, double v) {
    return Vector3(0.1 * u, 0.02 * std::sin(3.0 * u) * v + bump * std::exp(-400.0 * (u - 0.3) * (u - 0.3)),
                   -0.1 * v);
  };
  return shape;
}

TEST(FitShape, PutsKnotsWhereTheShapeAsksForThem) {
  const FittedShape plain = fitted(Result<ExactShape>(wave(0.0)));
  const FittedShape bumpy = fitted(Result<ExactShape>(wave(0.02)));
  EXPECT_LE(bumpy.deviation_m, 1e-5);
  EXPECT_GT(bumpy.surface.net.rows, plain.surface.net.rows);
  EXPECT_EQ(bumpy.surface.net.columns, plain.surface.net.columns);
  const auto spans_in = [&](double low, double high) {
    int count = 0;
    for (const double knot : bumpy.surface.u.breakpoints()) count += knot >= low && knot < high ? 1 : 0;
    return count;
  };
  EXPECT_GT(spans_in(0.2, 0.4), 2 * spans_in(0.6, 0.8));
}

TEST(FitShape, ACurvatureJumpIsMetAtABreak) {
  ExactShape bent;
  bent.u.breaks = {0.0, 0.37, 1.0};
  // The curve is straight and then an arc of radius 0.05. It is fitted to the tolerance with few spans,
  // because the curvature jump is at a knot.
  bent.at = [](double u, double v) {
    const double beyond = std::max(0.0, u - 0.37) / 0.5;
    return Vector3(0.1 * std::min(u, 0.37) + 0.05 * std::sin(beyond), 0.05 * (1.0 - std::cos(beyond)),
                   -0.05 * v);
  };
  const FittedShape shape = fitted(Result<ExactShape>(bent));
  EXPECT_LE(shape.deviation_m, 1e-5);
  EXPECT_LE(shape.surface.net.rows, 24);
}

TEST(FitShape, SaysWhatATightToleranceWants) {
  ExactShape kinked = wave(0.0);
  kinked.at = [](double u, double v) { return Vector3(0.1 * u, 0.1 * std::abs(u - 0.3141), -0.1 * v); };
  ShapeFit fit;
  fit.tolerance_m = 1e-9;
  const auto refused = fit_shape(kinked, fit);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::not_converged) << refused.error().message;
}

TEST(FitShape, TellsHowFarItIsAndStops) {
  ShapeFit fit;
  double last = 0.0;
  int asked = 0;
  fit.progress = Progress([&](double share) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1.0);
    last = share;
    ++asked;
    return true;
  });
  ASSERT_TRUE(fit_shape(wave(0.02), fit));
  EXPECT_GT(asked, 100);
  for (int stop = 1; stop < asked; stop += 7) {
    int left = stop;
    fit.progress = Progress([&](double) { return --left > 0; });
    const auto stopped = fit_shape(wave(0.02), fit);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  }
}

// A fit has a knot at each break. If the breaks require more control points than are allowed, the fit is
// refused before the shape is sampled.
TEST(FitShape, RefusesMoreBreaksThanControlPointsAtOnce) {
  ExactShape shape = wave(0.0);
  shape.v.breaks.clear();
  for (int k = 0; k <= 300; ++k) shape.v.breaks.push_back(k / 300.0);
  shape.at = [](double, double) -> Vector3 {
    ADD_FAILURE() << "the shape was sampled";
    return Vector3::Zero();
  };
  const auto refused = fit_shape(shape);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_converged) << refused.error().message;
}

TEST(FitShape, RefusesAShapeThatIsNotFinite) {
  ExactShape shape = wave(0.0);
  shape.at = [](double u, double v) { return Vector3(u, 1.0 / (v - 0.5), v); };
  shape.v.breaks = {0.0, 0.5, 1.0};
  EXPECT_FALSE(fit_shape(shape).ok());
}

TEST(FitShape, CountsAreAsAskedForAtAnyDegree) {
  for (int degree = 2; degree <= 5; ++degree) {
    ShapeFit fit;
    fit.degree = degree;
    fit.control_counts = {{degree + 9, degree + 1}};
    const FittedShape shape = fitted(Result<ExactShape>(wave(0.0)), fit);
    EXPECT_EQ(shape.surface.net.rows, degree + 9);
    EXPECT_EQ(shape.surface.net.columns, degree + 1);
    fit.control_counts = {{degree, degree + 1}};
    EXPECT_FALSE(fit_shape(wave(0.0), fit).ok());
  }
}

}  // namespace
}  // namespace spoonbill
