#include <gtest/gtest.h>

#include "engine/bspline/reparameterise.h"
#include "engine/merging/tube_ends.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

TEST(Seam, AnOpenedSurfaceIsClosedAgainExactly) {
  Random random(81);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const int degree = random.integer(2, 4);
    const Surface whole = random_surface(random, KnotVector::periodic_uniform(degree, 9).value(),
                                         KnotVector::clamped_uniform(3, 6).value());
    const double start = random.uniform(0.0, 1.0);
    const Surface opened = part_of(whole, Direction::u, start, start + 1.0).value();
    const auto closed = close_around(opened, Direction::u, degree - 1, 1e-6);
    ASSERT_TRUE(closed.ok()) << closed.error().message;
    EXPECT_LT(closed->deviation_m, 1e-10);
    EXPECT_TRUE(closed->surface.u.is_periodic());
    for (int k = 0; k < 40; ++k) {
      const double u = random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0);
      const Vector3 there = position(whole, whole.u.into_domain(start + u), v);
      EXPECT_LT((position(closed->surface, start + u, v) - there).norm(), 1e-11);
    }
  }
}

TEST(Seam, EdgesThatDoNotMeetAreRefused) {
  Random random(82);
  const Surface sheet = random_surface(random, KnotVector::clamped_uniform(3, 6).value(),
                                       KnotVector::periodic_uniform(3, 6).value());
  EXPECT_FALSE(close_around(sheet, Direction::u, 2, 1e-5).ok());
  EXPECT_EQ(close_around(sheet, Direction::v, 2, 1e-5).error().code, ErrorCode::inconsistent);
}

TEST(Seam, ASinglePieceIsClosedToo) {
  ControlNet net(4, 2);
  for (int j = 0; j < 2; ++j) {
    const double y = 0.02 * j;
    for (const int i : {0, 3}) net.set_point(i, j, {0, y, 0});
    net.set_point(1, j, {0.04, y, 0});
    net.set_point(2, j, {0, y, 0.04});
  }
  const Surface drop{KnotVector::clamped_uniform(3, 4).value(), KnotVector::clamped_uniform(1, 2).value(),
                     net};
  const auto closed = close_around(drop, Direction::u, 2, 1e-4);
  ASSERT_TRUE(closed.ok()) << closed.error().message;
  EXPECT_TRUE(closed->surface.u.is_periodic());
  for (double u = 0.0; u < 1.0; u += 0.01) {
    EXPECT_LE((position(closed->surface, u, 0.5) - position(drop, u, 0.5)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace spoonbill
