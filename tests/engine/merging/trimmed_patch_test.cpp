#include "engine/merging/trimmed_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/grid.h"
#include "engine/merging/merge.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

// Returns the sheet z = 0.01 sin(20 x) over 0.1 x 0.1 m. The equation shows for each point whether it is on
// the sheet.
Surface wave() {
  const auto knots = KnotVector::clamped_uniform(3, 16).value();
  PointGrid points{uniform_parameters(knots, 60), uniform_parameters(knots, 60), {}};
  for (const double a : points.u) {
    for (const double b : points.v) points.points_m.emplace_back(0.1 * a, 0.1 * b, 0.01 * std::sin(2.0 * a));
  }
  return fit_grid(knots, knots, points).value();
}

TrimLoop polygon(const std::vector<Eigen::Vector2d>& points) {
  const Surface surface = wave();
  return make_polygon_loop(surface.u, surface.v, points).value();
}

double largest_off_the_wave(const Surface& surface) {
  double largest = 0.0;
  const PointGrid points =
      sample_grid_points(surface, uniform_parameters(surface.u, 33), uniform_parameters(surface.v, 33));
  for (const Vector3& p : points.points_m)
    largest = std::max(largest, std::abs(p.z() - 0.01 * std::sin(20.0 * p.x())));
  return largest;
}

TEST(TrimmedPatch, EndsOnItsTrims) {
  // The loop keeps the part above a roof with a central ridge. Parameter lines end at the roof, so the edge
  // there has a kink.
  const auto whole =
      untrimmed(wave(), {polygon({{0.1, 0.2}, {0.5, 0.5}, {0.9, 0.2}, {0.9, 0.95}, {0.1, 0.95}})}, 2e-5);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  const Surface& surface = whole->surface;
  EXPECT_LT(largest_off_the_wave(surface), 3e-5);
  for (double share = 0.0; share <= 1.0; share += 0.05) {
    const double u = surface.u.domain_start() + share * (surface.u.domain_end() - surface.u.domain_start());
    const Vector3 low = position(surface, u, surface.v.domain_start()),
                  high = position(surface, u, surface.v.domain_end());
    EXPECT_NEAR(high.y(), 0.095, 2e-5);
    EXPECT_NEAR(low.y(), 0.02 + 0.75 * (0.04 - std::abs(low.x() - 0.05)), 6e-5) << low.x();
  }
}

TEST(TrimmedPatch, ARectangleIsAPart) {
  const Surface sheet = wave();
  const auto kept =
      untrimmed(sheet, {polygon({{0.2, 0.1}, {0.6, 0.1}, {0.9, 0.1}, {0.9, 0.7}, {0.2, 0.7}})}, 1e-5);
  ASSERT_TRUE(kept.ok()) << kept.error().message;
  EXPECT_EQ(kept->deviation_m, 0.0);
  EXPECT_EQ(kept->surface.u.domain_start(), 0.2);
  EXPECT_EQ(kept->surface.v.domain_end(), 0.7);
  EXPECT_LT((position(kept->surface, 0.31, 0.52) - position(sheet, 0.31, 0.52)).norm(), 1e-15);
}

TEST(TrimmedPatch, NoPointIsFartherThanTold) {
  const Surface sheet = wave();
  const auto slanted = untrimmed(sheet, {polygon({{0.0, 0.3}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 0.8}})}, 1e-4);
  ASSERT_TRUE(slanted.ok()) << slanted.error().message;
  double farthest = 0.0;
  for (const double u : uniform_parameters(slanted->surface.u, 401)) {
    const double low = 0.3 - 0.3 * u, high = 0.8 + 0.2 * u;
    for (const double share : {0.0, 0.13, 0.5, 1.0}) {
      const Vector3 there = position(sheet, u, low + share * (high - low));
      farthest = std::max(farthest, (position(slanted->surface, u, share) - there).norm());
    }
  }
  EXPECT_LE(farthest, slanted->deviation_m);
  EXPECT_LT(slanted->deviation_m, 1.2 * farthest + 1e-9);
}

TEST(TrimmedPatch, IsMergedWithItsNeighbour) {
  const Surface sheet = wave();
  const auto left = untrimmed(sheet, {polygon({{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.4}, {0.0, 0.6}})}, 1e-5);
  const auto right = untrimmed(sheet, {polygon({{0.0, 0.6}, {1.0, 0.4}, {1.0, 1.0}, {0.0, 1.0}})}, 1e-5);
  ASSERT_TRUE(left.ok() && right.ok());
  const auto merged = merge({left->surface, right->surface}, {});
  ASSERT_TRUE(merged.ok()) << merged.error().message;
  EXPECT_LE(merged->deviation_m, 5e-5);
  EXPECT_LT(largest_off_the_wave(merged->surface), 1e-4);
  const Surface& surface = merged->surface;
  EXPECT_NEAR(position(surface, surface.u.domain_end(), surface.v.domain_end()).y(), 0.1, 5e-5);
}

TEST(TrimmedPatch, LinesOfTheOtherDirectionServeToo) {
  // The notch is cut into one side. There, lines of constant u are cut into two pieces, and lines of constant
  // v are only shortened.
  const auto notched = untrimmed(
      wave(), {polygon({{0.0, 0.0}, {0.6, 0.0}, {0.6, 0.4}, {0.4, 0.5}, {0.6, 0.6}, {0.6, 1.0}, {0.0, 1.0}})},
      2e-5);
  ASSERT_TRUE(notched.ok()) << notched.error().message;
  EXPECT_LT(largest_off_the_wave(notched->surface), 3e-5);
}

TEST(TrimmedPatch, HolesAreRefused) {
  const TrimLoop outer = polygon({{0.05, 0.05}, {0.95, 0.05}, {0.95, 0.95}, {0.05, 0.95}});
  const TrimLoop hole = polygon({{0.4, 0.4}, {0.4, 0.6}, {0.6, 0.6}, {0.6, 0.4}});
  const auto refused = untrimmed(wave(), {outer, hole}, 2e-5);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::unsupported);
  EXPECT_EQ(untrimmed(wave(), {}, 1e-5)->deviation_m, 0.0);
}

TEST(TrimmedPatch, WhatLiesOutsideAHoleIsNotTakenForIt) {
  const auto refused = untrimmed(wave(), {polygon({{0.3, 0.3}, {0.3, 0.6}, {0.7, 0.6}, {0.7, 0.3}})}, 2e-5);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::unsupported);
}

// The gap and the slit are narrower than the steps between checked lines.
TEST(TrimmedPatch, NarrowGapsAndSlitsAreNotMissed) {
  const TrimLoop left = polygon({{0.1, 0.1}, {0.4003, 0.1}, {0.4003, 0.9}, {0.1, 0.9}});
  const TrimLoop right = polygon({{0.4004, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.4004, 0.9}});
  EXPECT_FALSE(untrimmed(wave(), {left, right}, 2e-5).ok());
  // The slit cuts lines of constant v into two pieces. The ends of lines of constant u jump at the slit.
  const TrimLoop slit = polygon({{0.1, 0.1},
                                 {0.403, 0.1},
                                 {0.403, 0.5},
                                 {0.4035, 0.5},
                                 {0.4035, 0.1},
                                 {0.9, 0.1},
                                 {0.9, 0.9},
                                 {0.1, 0.9}});
  EXPECT_FALSE(untrimmed(wave(), {slit}, 2e-5).ok());
}

TEST(TrimmedPatch, MoreCornersThanAPatchHoldsAreRefusedAtOnce) {
  std::vector<Eigen::Vector2d> saw;
  for (int k = 0; k <= 100; ++k) saw.emplace_back(0.1 + 0.008 * k, 0.1 + 0.05 * (k % 2));
  saw.insert(saw.end(), {{0.9, 0.9}, {0.1, 0.9}});
  const auto refused = untrimmed(wave(), {polygon(saw)}, 2e-5);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::too_many);
  EXPECT_NE(refused.error().message.find("on 99 lines"), std::string::npos) << refused.error().message;
}

TEST(TrimmedPatch, ALoopMayCrossTheSeam) {
  const auto u = KnotVector::periodic_uniform(3, 24).value();
  const auto v = KnotVector::clamped_uniform(3, 6).value();
  PointGrid points{uniform_parameters_without_seam(u, 96), uniform_parameters(v, 20), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      points.points_m.emplace_back(0.02 * std::cos(2 * M_PI * a), 0.06 * b, 0.02 * std::sin(2 * M_PI * a));
    }
  }
  const Surface pipe = fit_grid(u, v, points).value();
  const TrimLoop loop =
      make_polygon_loop(pipe.u, pipe.v, {{0.8, 0.2}, {1.1, 0.2}, {1.1, 0.7}, {0.8, 0.7}}).value();
  const auto whole = untrimmed(pipe, {loop}, 1e-5);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  const KnotVector& along = whole->surface.u;
  const Vector3 first = position(whole->surface, along.domain_start(), whole->surface.v.domain_start());
  EXPECT_NEAR((first - position(pipe, 0.8, 0.2)).norm(), 0.0, 1e-5);
  const Vector3 last = position(whole->surface, along.domain_end(), whole->surface.v.domain_end());
  EXPECT_NEAR((last - position(pipe, 0.1, 0.7)).norm(), 0.0, 1e-5);
}

}  // namespace
}  // namespace spoonbill
