#include "engine/bspline/reparameterise.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

// Tolerance for rounding errors of points. Coordinates are below 1 m, and points are only weighted means of
// control points.
constexpr double same_point = 1e-13;

// Expects b at (u, v) to be the same point as a at in_a(u, v).
template <class InA>
void expect_same_surface(Random& random, const Surface& a, const Surface& b, const InA& in_a) {
  for (int sample = 0; sample < 30; ++sample) {
    const double u = random.uniform(b.u.domain_start(), b.u.domain_end());
    const double v = random.uniform(b.v.domain_start(), b.v.domain_end());
    const auto [au, av] = in_a(u, v);
    ASSERT_LT((position(a, au, av) - position(b, u, v)).norm(), same_point) << u << " " << v;
  }
}

TEST(Reparameterise, RunsBackwards) {
  Random random(61);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Surface surface = random_surface(random);
    const Surface back_u = reversed(surface, Direction::u), back_v = reversed(surface, Direction::v);
    expect_same_surface(random, surface, back_u, [&](double u, double v) {
      return std::pair(surface.u.domain_start() + (surface.u.domain_end() - u), v);
    });
    expect_same_surface(random, surface, back_v, [&](double u, double v) {
      return std::pair(u, surface.v.domain_start() + (surface.v.domain_end() - v));
    });
  }
}

TEST(Reparameterise, ExchangesUAndV) {
  Random random(62);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const Surface surface = random_surface(random);
    expect_same_surface(random, surface, exchanged(surface),
                        [](double u, double v) { return std::pair(v, u); });
  }
}

TEST(Reparameterise, MovesTheSeam) {
  Random random(63);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const int degree = random.integer(1, 6);
    const Surface surface =
        random_surface(random, random_knots(random, degree, KnotKind::periodic), random_knots(random));
    const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
    const auto breaks = surface.u.breakpoints();
    const double seam = repeat % 3 == 0 ? breaks[random.integer(0, static_cast<int>(breaks.size()) - 1)]
                                        : start + random.uniform(-1.0, 2.0) * length;
    const auto moved = with_seam_at(surface, Direction::u, seam);
    ASSERT_TRUE(moved.ok()) << moved.error().message;
    EXPECT_EQ(moved->u.domain_start(), start);
    EXPECT_EQ(moved->u.domain_end(), surface.u.domain_end());
    expect_same_surface(random, surface, moved.value(), [&](double u, double v) {
      return std::pair(surface.u.into_domain(u - start + surface.u.into_domain(seam)), v);
    });
  }
}

TEST(Reparameterise, StretchesTheDomain) {
  Random random(64);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Surface surface = random_surface(random);
    const auto stretched = with_domain(surface, Direction::v, -2.0, 3.0);
    ASSERT_TRUE(stretched.ok());
    const double start = surface.v.domain_start(), length = surface.v.domain_end() - start;
    expect_same_surface(random, surface, stretched.value(),
                        [&](double u, double v) { return std::pair(u, start + (v + 2.0) / 5.0 * length); });
  }
  Random other(65);
  EXPECT_FALSE(with_domain(random_surface(other), Direction::u, 1.0, 1.0).ok());
}

TEST(Reparameterise, RefusesASeamOfAnOpenDirection) {
  Random random(66);
  const Surface surface = random_surface(random, KnotVector::clamped_uniform(3, 6).value(),
                                         KnotVector::periodic_uniform(3, 6).value());
  EXPECT_FALSE(with_seam_at(surface, Direction::u, 0.5).ok());
  EXPECT_TRUE(with_seam_at(surface, Direction::v, 0.5).ok());
}

}  // namespace
}  // namespace spoonbill
