#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/merging/bridge.h"

namespace spoonbill {
namespace {

// Returns a ribbon, 50 mm wide along x, that follows a curve in the y-z plane. `climb` returns the curve's
// angle of climb at a parameter from 0 to 1.
Surface ribbon(const std::function<double(double)>& climb) {
  const auto u = KnotVector::clamped_uniform(3, 5).value(), v = KnotVector::clamped_uniform(3, 40).value();
  PointGrid points{uniform_parameters(u, 12), uniform_parameters(v, 161), {}};
  for (const double a : points.u) {
    Vector3 at(0.05 * a, 0, 0);
    for (const double b : points.v) {
      points.points_m.push_back(at);
      at += 0.001 * Vector3(0, std::cos(climb(b)), std::sin(climb(b)));
    }
  }
  return fit_grid(u, v, points).value();
}

// The strip turns by up to 162 degrees and back, but never by a right angle between two samples.
TEST(FoldSearch, AStripThatTurnsBackSlowlyFolds) {
  const Surface back =
      ribbon([](double t) { return 0.9 * std::numbers::pi * std::sin(t * std::numbers::pi); });
  EXPECT_FALSE(find_fold(back).has_value());
  EXPECT_TRUE(find_fold_between(back, 0.0, 1.0).has_value());
  EXPECT_FALSE(find_fold_between(back, 0.0, 0.2).has_value());
}

TEST(FoldSearch, AStripThatLeadsElsewhereDoesNot) {
  EXPECT_FALSE(find_fold_between(ribbon([](double t) { return 3.0 * t; }), 0.0, 1.0).has_value());
  EXPECT_FALSE(find_fold_between(ribbon([](double) { return 0.3; }), 0.0, 1.0).has_value());
}

TEST(FoldSearch, AnEdgeIsNoFold) {
  const auto u = KnotVector::clamped_uniform(3, 5).value();
  const auto edge = KnotVector::open(3, {0, 0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1, 1}).value();
  const auto smooth = KnotVector::open(3, {0, 0, 0, 0, 0.45, 0.5, 0.55, 1, 1, 1, 1}).value();
  const auto roof = [&](const KnotVector& v) {
    ControlNet net(5, 7);
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 7; ++j) net.set_point(i, j, {0.01 * i, 0.01 * std::abs(3 - j), 1e-5 * j});
    }
    return Surface{u, v, net};
  };
  EXPECT_FALSE(find_fold(roof(edge)).has_value());
  EXPECT_TRUE(find_fold(roof(smooth)).has_value());
}

}  // namespace
}  // namespace spoonbill
