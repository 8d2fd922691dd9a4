#include "engine/bspline/change_knots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/bspline/reparameterise.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

double largest_difference(Random& random, const Surface& a, const Surface& b,
                          Direction along = Direction::u) {
  double largest = 0.0;
  for (int sample = 0; sample < 60; ++sample) {
    // The surfaces are compared on the part of the domain that is common to both.
    const KnotVector &ka = knots_along(a, along), &kb = knots_along(b, along);
    const double t = random.uniform(kb.domain_start(), kb.domain_end());
    const KnotVector& other = along == Direction::u ? b.v : b.u;
    const double s = random.uniform(other.domain_start(), other.domain_end());
    const bool u = along == Direction::u;
    const double in_a = ka.is_periodic() ? ka.into_domain(t) : t;
    largest = std::max(largest,
                       (position(a, u ? in_a : s, u ? s : in_a) - position(b, u ? t : s, u ? s : t)).norm());
  }
  return largest;
}

// Tolerance for the distance of two surfaces that are equal except for rounding, with coordinates below 1 m.
// The dual functionals of degree 9 have norms of some thousands (de Boor 1990), and knot intervals that
// differ fivefold increase the error further.
constexpr double same_surface = 1e-11;

Direction any_direction(Random& random) {
  return random.integer(0, 1) == 0 ? Direction::u : Direction::v;
}

TEST(ChangeKnots, ElevationKeepsTheSurface) {
  Random random(31);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction along = any_direction(random);
    const KnotVector& knots = knots_along(surface, along);
    const auto higher = elevate_degree(knots, random.integer(knots.degree(), max_degree));
    ASSERT_TRUE(higher.ok()) << higher.error().message;
    const auto changed = convert_to_finer_knots(surface, along, higher.value());
    ASSERT_TRUE(changed.ok()) << changed.error().message;
    EXPECT_LT(largest_difference(random, surface, changed.value(), along), same_surface);
  }
}

TEST(ChangeKnots, AgreesWithKnotInsertion) {
  Random random(32);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction along = any_direction(random);
    const KnotVector& knots = knots_along(surface, along);
    const double knot = random.uniform(knots.domain_start(), knots.domain_end());
    const Surface inserted = insert_knot(surface, along, knot, random.integer(1, knots.degree())).value();
    const auto changed = convert_to_finer_knots(surface, along, knots_along(inserted, along));
    ASSERT_TRUE(changed.ok()) << changed.error().message;
    for (std::size_t k = 0; k < inserted.net.size(); ++k) {
      EXPECT_NEAR(changed->net.x[k], inserted.net.x[k], same_surface);
      EXPECT_NEAR(changed->net.z[k], inserted.net.z[k], same_surface);
    }
  }
}

TEST(ChangeKnots, TakesPartsAlsoAcrossASeam) {
  Random random(33);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction along = any_direction(random);
    const KnotVector& knots = knots_along(surface, along);
    const double length = knots.domain_end() - knots.domain_start();
    const double start = knots.domain_start() + random.uniform(0.0, 0.9) * length;
    const double end = knots.is_periodic() ? start + random.uniform(0.1, 1.0) * length
                                           : random.uniform(start, knots.domain_end());
    const auto part = clamped_part(knots, start, end);
    ASSERT_TRUE(part.ok()) << part.error().message;
    const auto cut = convert_to_finer_knots(surface, along, part.value());
    ASSERT_TRUE(cut.ok()) << cut.error().message;
    // The tolerance also holds for a part that is a small piece of a long span. Its control points are values
    // of the span's polar form (blossom) at parameters within the piece, so nothing is extrapolated.
    EXPECT_LT(largest_difference(random, surface, cut.value(), along), same_surface);
  }
}

TEST(ChangeKnots, NamesAKnotThatIsMissing) {
  Random random(34);
  const auto u = KnotVector::open(3, {0, 0, 0, 0, 0.25, 0.5, 1, 1, 1, 1}).value();
  const Surface surface = random_surface(random, u, KnotVector::clamped_uniform(2, 4).value());
  const auto lacking = KnotVector::open(3, {0, 0, 0, 0, 0.5, 1, 1, 1, 1}).value();
  const auto changed = convert_to_finer_knots(surface, Direction::u, lacking);
  ASSERT_FALSE(changed.ok());
  EXPECT_EQ(changed.error().message, "direction u: the new knots lack the surface's knot 0.25; insert it");
}

TEST(ChangeKnots, CoarserKnotsGiveBackWhatWasRefined) {
  Random random(35);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction along = any_direction(random);
    const KnotVector& knots = knots_along(surface, along);
    const int degree = std::min(knots.degree() + 2, max_degree);
    const auto target = elevate_degree(knots, knots.degree());
    const Surface clamped = convert_to_finer_knots(surface, along, target.value()).value();
    const Surface finer =
        convert_to_finer_knots(clamped, along, elevate_degree(knots, degree).value()).value();
    const auto back = fit_coarser_knots(finer, along, target.value());
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_LT(back->deviation_m, 1e-10);
    EXPECT_LT(largest_difference(random, clamped, back->surface, along), 1e-10);
  }
}

TEST(ChangeKnots, TheDeviationOfACoarserSurfaceIsNeverPassed) {
  Random random(36);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction along = any_direction(random);
    const KnotVector& knots = knots_along(surface, along);
    const int degree = random.integer(1, knots.degree());
    const auto fewer = reduce_degree(knots, degree);
    ASSERT_TRUE(fewer.ok()) << fewer.error().message;
    const auto coarse = fit_coarser_knots(surface, along, fewer.value());
    ASSERT_TRUE(coarse.ok()) << coarse.error().message;
    const double seen = largest_difference(random, surface, coarse->surface, along);
    EXPECT_LE(seen, coarse->deviation_m + 1e-12);
    // The deviation is bounded even for a coarse fit, because its control points exceed the size of the
    // surface by at most a factor that grows with the degree.
    EXPECT_LE(coarse->deviation_m, 1.0);
  }
}

TEST(ChangeKnots, ReducedDegreeReachesATolerance) {
  Random random(37);
  const Surface surface = random_surface(random, KnotVector::clamped_uniform(5, 9).value(),
                                         KnotVector::periodic_uniform(3, 8).value());
  const KnotVector first = reduce_degree(surface.u, 3).value();
  const auto cubic = approximated(surface, Direction::u, first, 1e-5, 400);
  ASSERT_TRUE(cubic.ok()) << cubic.error().message;
  EXPECT_LE(cubic->deviation_m, 1e-5);
  EXPECT_LE(largest_difference(random, surface, cubic->surface), 1e-5);
  EXPECT_EQ(cubic->surface.u.degree(), 3);
  const auto refused = approximated(surface, Direction::u, first, 1e-9, 20);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::not_converged) << refused.error().message;
}

TEST(ChangeKnots, SpareKnotsGoAndOthersStay) {
  Random random(38);
  const auto u = KnotVector::open(3, {0, 0, 0, 0, 0.25, 0.5, 1, 1, 1, 1}).value();
  const Surface surface = random_surface(random, u, KnotVector::periodic_uniform(2, 6).value());
  Surface finer = surface;
  for (const double knot : {0.1, 0.3, 0.8}) finer = insert_knot(finer, Direction::u, knot, 2).value();
  finer = insert_knot(finer, Direction::v, 0.3, 1).value();
  const auto u_back = remove_spare_knots(finer, Direction::u, 1e-10);
  ASSERT_TRUE(u_back.ok());
  EXPECT_EQ(u_back->surface.u, surface.u);
  const auto back = remove_spare_knots(u_back->surface, Direction::v, 1e-10);
  EXPECT_EQ(back->surface.v, surface.v);
  EXPECT_LT(largest_difference(random, surface, back->surface), 1e-10);
}

TEST(ChangeKnots, SpareKnotsOfUnclampedAndOfLongDirectionsGo) {
  Random random(40);
  // In an unclamped direction, knot removal joins the four pieces of one cubic polynomial into one piece.
  const auto unclamped =
      KnotVector::open(3, {-0.3, -0.2, -0.1, 0, 0.25, 0.5, 0.75, 1, 1.1, 1.2, 1.3}).value();
  const auto single = KnotVector::open(3, {-0.3, -0.2, -0.1, 0, 1, 1.1, 1.2, 1.3}).value();
  const Surface surface = random_surface(random, single, KnotVector::clamped_uniform(2, 4).value());
  Surface finer = surface;
  for (const double knot : {0.25, 0.5, 0.75}) finer = insert_knot(finer, Direction::u, knot, 1).value();
  ASSERT_EQ(finer.u, unclamped);
  const auto back = remove_spare_knots(finer, Direction::u, 1e-10);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->surface.u, single);
  for (const bool periodic : {false, true}) {
    const auto coarse =
        (periodic ? KnotVector::periodic_uniform(3, 12) : KnotVector::clamped_uniform(3, 12)).value();
    const Surface few = random_surface(random, coarse, KnotVector::clamped_uniform(2, 4).value());
    Surface many = few;
    for (int k = 1; k < 80; ++k) many = insert_knot(many, Direction::u, (k + 0.37) / 80.0, 1 + k % 2).value();
    const auto spared = remove_spare_knots(many, Direction::u, 1e-9);
    ASSERT_TRUE(spared.ok());
    EXPECT_EQ(spared->surface.u, coarse) << periodic;
    EXPECT_LE(largest_difference(random, few, spared->surface), 1e-9);
  }
}

TEST(KnotVectors, UnionTakesNearlyEqualKnotsAsOne) {
  const auto a = KnotVector::open(2, {0, 0, 0, 0.3, 0.7, 0.7, 1, 1, 1}).value();
  const auto b = KnotVector::open(2, {0, 0, 0, 0.3 + 1e-13, 0.5, 0.7, 1, 1, 1}).value();
  const auto both = knot_union(a, b);
  ASSERT_TRUE(both.ok());
  EXPECT_EQ(both->knots(), (std::vector<double>{0, 0, 0, 0.3, 0.5, 0.7, 0.7, 1, 1, 1}));
  EXPECT_FALSE(knot_union(a, KnotVector::clamped_uniform(3, 5).value()).ok());
  EXPECT_FALSE(knot_union(a, KnotVector::periodic_uniform(2, 5).value()).ok());
}

TEST(KnotVectors, ReversedTwiceIsTheSame) {
  Random random(39);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const KnotVector knots = random_knots(random);
    const KnotVector back = reversed(reversed(knots));
    ASSERT_EQ(back.knots().size(), knots.knots().size());
    for (std::size_t k = 0; k < knots.knots().size(); ++k) {
      EXPECT_NEAR(back.knots()[k], knots.knots()[k], 1e-15 * std::abs(knots.domain_end()) + 1e-15);
    }
  }
}

}  // namespace
}  // namespace spoonbill
