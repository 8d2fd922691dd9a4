#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/bspline/change_knots.h"
#include "engine/bspline/reparameterise.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

TEST(KnotRemoval, WhatWasInsertedIsTakenOutExactly) {
  Random random(91);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction direction = repeat % 2 == 0 ? Direction::u : Direction::v;
    const KnotVector& knots = knots_along(surface, direction);
    const double start = knots.domain_start(), end = knots.domain_end();
    const double place = start + (end - start) * random.uniform(0.1, 0.9);
    const int copies = random.integer(1, knots.degree());
    const auto finer = insert_knot(surface, direction, place, copies);
    ASSERT_TRUE(finer.ok()) << finer.error().message;
    const auto back = remove_knot(finer.value(), direction, place, copies);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(knots_along(back->surface, direction).control_point_count(), knots.control_point_count());
    // The surfaces have a size of 1 m; least squares of degree 9 lose about eight digits.
    EXPECT_LT(back->deviation_m, 1e-8);
    for (int k = 0; k < 20; ++k) {
      const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
      const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
      EXPECT_LT((position(surface, u, v) - position(back->surface, u, v)).norm(), 1e-8);
    }
  }
}

TEST(KnotRemoval, TellsHowFarTheSurfaceMoves) {
  Random random(92);
  for (const bool periodic : {false, true}) {
    const auto knots =
        (periodic ? KnotVector::periodic_uniform(3, 9) : KnotVector::clamped_uniform(3, 9)).value();
    const Surface surface = random_surface(random, knots, KnotVector::clamped_uniform(2, 5).value());
    const double knot = knots.breakpoints()[2];
    const auto fewer = remove_knot(surface, Direction::u, knot, 1);
    ASSERT_TRUE(fewer.ok()) << fewer.error().message;
    EXPECT_EQ(fewer->surface.u.control_point_count(), 8);
    double largest = 0.0;
    for (double u = 0.0; u <= 1.0; u += 0.01) {
      for (double v = 0.0; v <= 1.0; v += 0.1) {
        largest = std::max(largest, (position(surface, u, v) - position(fewer->surface, u, v)).norm());
      }
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LE(largest, fewer->deviation_m);
  }
}

TEST(KnotRemoval, RefusesWhatIsNotThere) {
  Random random(93);
  const Surface surface = random_surface(random, KnotVector::periodic_uniform(3, 8).value(),
                                         KnotVector::clamped_uniform(3, 6).value());
  EXPECT_FALSE(remove_knot(surface, Direction::v, 0.4, 1).ok());
  EXPECT_FALSE(remove_knot(surface, Direction::v, 0.0, 1).ok());
  EXPECT_FALSE(remove_knot(surface, Direction::v, 1.0, 1).ok());
  EXPECT_FALSE(remove_knot(surface, Direction::u, 0.0, 1).ok());
  EXPECT_FALSE(remove_knot(surface, Direction::u, 1.0, 1).ok());
  const auto often = remove_knot(surface, Direction::u, 0.25, 2);
  ASSERT_FALSE(often.ok());
  EXPECT_EQ(often.error().code, ErrorCode::too_few) << often.error().message;
  EXPECT_FALSE(remove_knot(random_surface(random, KnotVector::clamped_uniform(3, 4).value(),
                                          KnotVector::clamped_uniform(3, 4).value()),
                           Direction::u, 0.5, 1)
                   .ok());
}

}  // namespace
}  // namespace spoonbill
