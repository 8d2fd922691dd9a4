#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "engine/bspline/basis.h"
#include "engine/bspline/reparameterise.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

double largest_distance(Random& random, const Surface& a, const Surface& b) {
  double largest = 0.0;
  for (int sample = 0; sample < 60; ++sample) {
    const double u = random.uniform(a.u.domain_start(), a.u.domain_end());
    const double v = random.uniform(a.v.domain_start(), a.v.domain_end());
    largest = std::max(largest, (evaluate(a, u, v).position_m - evaluate(b, u, v).position_m).norm());
  }
  return largest;
}

int count_of(const KnotVector& knots, double knot) {
  return static_cast<int>(std::count(knots.knots().begin(), knots.knots().end(), knot));
}

// Tolerance for rounding errors of points. Coordinates are below 1 m, and knot insertion computes only
// weighted means of them.
constexpr double insertion_rounding = 1e-14;

TEST(KnotInsertion, KeepsTheSurface) {
  Random random(8);
  for (int repeat = 0; repeat < 500; ++repeat) {
    const Surface surface = random_surface(random);
    const Direction direction = random.integer(0, 1) == 0 ? Direction::u : Direction::v;
    const KnotVector& knots = direction == Direction::u ? surface.u : surface.v;
    const double knot = random.uniform(knots.domain_start(), knots.domain_end());
    const int multiplicity = random.integer(1, knots.degree());
    const auto finer = insert_knot(surface, direction, knot, multiplicity);
    ASSERT_TRUE(finer.ok()) << finer.error().message;
    const KnotVector& finer_knots = direction == Direction::u ? finer->u : finer->v;
    EXPECT_EQ(finer_knots.control_point_count(), knots.control_point_count() + multiplicity);
    EXPECT_EQ(count_of(finer_knots, knot), multiplicity);
    EXPECT_LT(largest_distance(random, surface, finer.value()), insertion_rounding);
  }
}

TEST(KnotInsertion, RaisesExistingKnots) {
  Random random(9);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const Surface surface = random_surface(random);
    const std::vector<double> breaks = surface.v.breakpoints();
    const double knot =
        breaks[static_cast<std::size_t>(random.integer(0, static_cast<int>(breaks.size()) - 2))];
    if (!surface.v.is_periodic() && knot == breaks.front()) continue;
    const auto finer = insert_knot(surface, Direction::v, knot, surface.v.degree());
    ASSERT_TRUE(finer.ok()) << finer.error().message;
    EXPECT_LT(largest_distance(random, surface, finer.value()), insertion_rounding);
    // At a knot whose multiplicity is the degree, the surface passes through control points.
    const BasisFunctions basis = basis_functions(finer->v, knot);
    EXPECT_NEAR(basis.values[0][0], 1.0, 1e-15);
    EXPECT_FALSE(insert_knot(surface, Direction::v, knot, surface.v.degree() + 1).ok());
  }
}

TEST(KnotInsertion, DoesNothingWhereTheKnotIsMultipleEnough) {
  Random random(10);
  const auto u = KnotVector::open(3, {0, 0, 0, 0, 0.5, 0.5, 1, 1, 1, 1}).value();
  const auto v = KnotVector::periodic(2, {0, 0.5, 1, 1}).value();
  const Surface surface = random_surface(random, u, v);
  EXPECT_EQ(insert_knot(surface, Direction::u, 0.5, 2)->u, u);
  EXPECT_EQ(insert_knot(surface, Direction::u, 0.5, 1)->net.x, surface.net.x);
  EXPECT_EQ(insert_knot(surface, Direction::v, 0.0, 2)->v, v);
  EXPECT_EQ(insert_knot(surface, Direction::v, 1.0, 2)->v, v);
}

TEST(KnotInsertion, AgreesWithBoehmOnACubicByHand) {
  // Splitting a Bezier curve at 1/2 gives de Casteljau's points. The test uses one coordinate.
  const auto u = KnotVector::clamped_uniform(3, 4).value();
  const auto v = KnotVector::clamped_uniform(1, 2).value();
  ControlNet net(4, 2);
  const double heights[] = {0, 8, 16, 0};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) net.set_point(i, j, {double(i), heights[i], double(j)});
  }
  const Surface cut = insert_knot(make_surface(u, v, net).value(), Direction::u, 0.5, 3).value();
  const double expected[] = {0, 4, 8, 9, 10, 8, 0};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(cut.net.point(i, 1).y(), expected[i]);
}

TEST(KnotInsertion, RefusesByName) {
  Random random(11);
  const Surface surface = random_surface(random, KnotVector::clamped_uniform(2, 5).value(),
                                         KnotVector::periodic_uniform(3, 6).value());
  const auto expect_refused = [&](Direction direction, double knot, int multiplicity, const char* context) {
    const auto result = insert_knot(surface, direction, knot, multiplicity);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::out_of_range) << result.error().message;
    EXPECT_EQ(result.error().message.find(context), 0u) << result.error().message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused(Direction::u, 0.0, 1, "direction u: knot 0");
  expect_refused(Direction::u, 1.0, 1, "direction u: knot 1");
  expect_refused(Direction::u, nan, 1, "direction u: knot nan");
  expect_refused(Direction::v, nan, 1, "direction v: knot nan");
  expect_refused(Direction::v, 0.5, 4, "direction v: multiplicity 4");
  expect_refused(Direction::u, 0.5, 0, "direction u: multiplicity 0");
  EXPECT_TRUE(insert_knot(surface, Direction::v, 1.0, 3).ok());
}

}  // namespace
}  // namespace spoonbill
