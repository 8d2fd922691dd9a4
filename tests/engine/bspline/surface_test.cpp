#include "engine/bspline/surface.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

TEST(Surface, RefusesANetThatDoesNotFit) {
  const auto u = KnotVector::clamped_uniform(3, 6).value();
  const auto v = KnotVector::clamped_uniform(3, 5).value();
  const auto transposed = make_surface(u, v, ControlNet(5, 6));
  ASSERT_FALSE(transposed.ok());
  EXPECT_EQ(transposed.error().code, ErrorCode::mismatch) << transposed.error().message;
  ControlNet short_net(6, 5);
  short_net.y.pop_back();
  const auto missing = make_surface(u, v, short_net);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::mismatch) << missing.error().message;
}

TEST(Surface, RefusesCoordinatesThatAreNotFinite) {
  const auto knots = KnotVector::clamped_uniform(1, 3).value();
  ControlNet net(3, 3);
  net.z[5] = std::numeric_limits<double>::infinity();
  const auto surface = make_surface(knots, knots, net);
  ASSERT_FALSE(surface.ok());
  EXPECT_NE(surface.error().message.find("control point (1, 2): z (inf) is not a finite number"),
            std::string::npos);
}

TEST(Surface, WrapsAndClampsParameters) {
  Random random(12);
  const Surface surface = random_surface(random, KnotVector::clamped_uniform(3, 6).value(),
                                         KnotVector::periodic_uniform(3, 7).value());
  EXPECT_EQ(evaluate(surface, -0.5, 0.25).position_m, evaluate(surface, 0.0, 0.25).position_m);
  EXPECT_EQ(evaluate(surface, 2.0, 1.25).position_m, evaluate(surface, 1.0, 0.25).position_m);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(evaluate(surface, nan, nan).position_m.allFinite());
}

// Four central control points are raised by 3 above a flat net.
TEST(Surface, SpikeHasItsHeight) {
  const auto knots = KnotVector::clamped_uniform(3, 8).value();
  ControlNet net(8, 8);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const bool centre = (i == 3 || i == 4) && (j == 3 || j == 4);
      net.set_point(i, j, {double(i), double(j), centre ? 3.0 : 0.0});
    }
  }
  const Surface surface = make_surface(knots, knots, net).value();
  // The exact height is 3 (23/24)^2.
  EXPECT_NEAR(evaluate(surface, 0.5, 0.5).position_m.z(), 2.755208333333333, 1e-14);
}

TEST(Surface, DerivativesMatchDifferences) {
  Random random(13);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Surface surface =
        random_surface(random, KnotVector::clamped_uniform(random.integer(3, 6), 8).value(),
                       KnotVector::periodic_uniform(random.integer(3, 6), 8).value());
    const double u = random.uniform(0.01, 0.99), v = random.uniform(0.01, 0.99), h = 1e-6;
    const SurfacePoint here = evaluate(surface, u, v);
    const SurfacePoint u0 = evaluate(surface, u - h, v), u1 = evaluate(surface, u + h, v);
    const SurfacePoint v0 = evaluate(surface, u, v - h), v1 = evaluate(surface, u, v + h);
    // The tolerance covers both errors of central differences with step h: the rounding of derivatives up to
    // about 1e3, divided by h, and third derivatives times h^2.
    const double tolerance = 1e-3;
    EXPECT_LT((here.du - (u1.position_m - u0.position_m) / (2 * h)).norm(), tolerance);
    EXPECT_LT((here.dv - (v1.position_m - v0.position_m) / (2 * h)).norm(), tolerance);
    EXPECT_LT((here.duu - (u1.du - u0.du) / (2 * h)).norm(), tolerance);
    EXPECT_LT((here.duv - (v1.du - v0.du) / (2 * h)).norm(), tolerance);
    EXPECT_LT((here.dvv - (v1.dv - v0.dv) / (2 * h)).norm(), tolerance);
  }
}

TEST(Surface, ThePositionAloneHasTheSameBits) {
  Random random(41);
  for (int trial = 0; trial < 200; ++trial) {
    const Surface surface = random_surface(random);
    const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
    const double v = trial % 10 == 0 ? surface.v.domain_end()
                                     : random.uniform(surface.v.domain_start(), surface.v.domain_end());
    EXPECT_EQ(position(surface, u, v), evaluate(surface, u, v).position_m) << trial;
  }
}

}  // namespace
}  // namespace spoonbill
