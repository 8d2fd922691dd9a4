#include "engine/shapes/smooth_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace spoonbill {
namespace {

using std::numbers::pi;

std::vector<Vector3> circle(int count) {
  std::vector<Vector3> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * pi * k / count;
    points.emplace_back(std::cos(angle), std::sin(angle), 0.3);
  }
  return points;
}

// A periodic spline through n points of a unit circle deviates from it by about (2 pi / n)^4 / 384.
TEST(SmoothCurve, ThroughACircleIsNearlyOne) {
  const SmoothCurve curve = SmoothCurve::through(circle(24), true).value();
  for (double t = 0.0; t < curve.end(); t += 0.01) {
    EXPECT_NEAR(curve.at(t).head<2>().norm(), 1.0, 2e-5);
    EXPECT_NEAR(curve.at(t).z(), 0.3, 1e-14);
  }
  EXPECT_LT((curve.at(0.0) - curve.at(curve.end())).norm(), 1e-12);
  EXPECT_LT((curve.first_derivative(1e-9) - curve.first_derivative(curve.end() - 1e-9)).norm(), 1e-6);
  EXPECT_LT((curve.second_derivative(1e-9) - curve.second_derivative(curve.end() - 1e-9)).norm(), 1e-6);
}

TEST(SmoothCurve, MeetsItsPointsWithContinuousCurvature) {
  const std::vector<Vector3> points = {{0, 0, 0}, {1, 0.5, 0}, {1.2, 2, 1}, {4, 2.5, 1}, {4, 3, 0}};
  const SmoothCurve curve = SmoothCurve::through(points, false).value();
  double t = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0) t += (points[k] - points[k - 1]).norm();
    EXPECT_LT((curve.at(t) - points[k]).norm(), 1e-12);
    if (k == 0 || k + 1 == points.size()) continue;
    EXPECT_LT((curve.first_derivative(t - 1e-9) - curve.first_derivative(t + 1e-9)).norm(), 1e-7);
    EXPECT_LT((curve.second_derivative(t - 1e-9) - curve.second_derivative(t + 1e-9)).norm(), 1e-6);
  }
  EXPECT_LT(curve.second_derivative(0.0).norm(), 1e-12);
}

TEST(SmoothCurve, EndsLevelWhereAsked) {
  CurveEnds level;
  level.level_y = true;
  const SmoothCurve curve =
      SmoothCurve::through({{0, 0, 0}, {1, 1, 0}, {2, 0.5, 0}}, false, level, level).value();
  EXPECT_NEAR(curve.first_derivative(0.0).y(), 0.0, 1e-12);
  EXPECT_NEAR(curve.first_derivative(curve.end()).y(), 0.0, 1e-12);
  EXPECT_GT(curve.first_derivative(0.0).x(), 0.1);
}

TEST(SmoothCurve, RefusesPointsThatMakeNone) {
  EXPECT_FALSE(SmoothCurve::through({}, false).ok());
  EXPECT_FALSE(SmoothCurve::through({{1, 2, 3}}, false).ok());
  EXPECT_FALSE(SmoothCurve::through(circle(2), true).ok());
  const auto refused = SmoothCurve::through({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}}, false);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("points 2 and 3"), std::string::npos);
  EXPECT_FALSE(SmoothCurve::through({{0, 0, 0}, {1, 0, 0}, {std::nan(""), 0, 0}}, false).ok());
}

}  // namespace
}  // namespace spoonbill
