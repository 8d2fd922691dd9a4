#include "engine/collision/surfaces/surface_pair_collider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/surfaces/random_pairs.h"
#include "tests/engine/collision/surfaces/reference_distance.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

struct PairAnswer {
  PairResult result;
  std::vector<PairContact> contacts;
};

PairAnswer collide(const Surface& first, const Surface& second, const PairQuery& query, int levels = 2) {
  const NestedGrid a = make_nested_grid(first.u, first.v, levels).value();
  const NestedGrid b = make_nested_grid(second.u, second.v, levels).value();
  SurfacePairCollider collider(a, b);
  const PairResult result = collider.collide(first, second, query);
  return {result, collider.contacts()};
}

// Returns z = a x^2 + b y^2 + c over a square of side 2, exactly, as a biquadratic surface.
Surface paraboloid(double a, double b, double c) {
  const KnotVector knots = KnotVector::open(2, {-1, -1, -1, 1, 1, 1}).value();
  const double abscissae[] = {-1, 0, 1}, squares[] = {1, -1, 1};  // the coefficients of x and x^2
  ControlNet net(3, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      net.set_point(i, j, {abscissae[i], abscissae[j], a * squares[i] + b * squares[j] + c});
    }
  }
  return make_surface(knots, knots, net).value();
}

// Returns a closed box with the given half sides. Each ring has four corners. The corners of the first and of
// the last ring coincide at the centre of their end face.
Surface box(const Vector3& half, const Vector3& centre) {
  const KnotVector around = KnotVector::periodic_uniform(1, 4).value();
  const KnotVector along = KnotVector::clamped_uniform(1, 4).value();
  const double x[] = {-1, 1, 1, -1}, y[] = {-1, -1, 1, 1}, z[] = {-1, -1, 1, 1}, wide[] = {0, 1, 1, 0};
  ControlNet net(4, 4);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      net.set_point(i, j, centre + half.cwiseProduct(Vector3(wide[j] * x[i], wide[j] * y[i], z[j])));
    }
  }
  return make_surface(around, along, net).value();
}

// Tolerance of results of Newton's method in double precision, on surfaces of 1 m.
constexpr double exact_m = 1e-9;
// Tolerance of normals. Newton's method ends when a step reduces the distance by less than about 1e-15 m;
// positions, and with them the normals, are accurate to about the square root of this number.
constexpr double exact_normal = 1e-7;

TEST(SurfacePair, AParaboloidReachesThroughAPlaneByItsVertex) {
  const Surface plane = paraboloid(0, 0, 0);
  for (const double depth : {1e-5, 1e-3, 0.02, 0.3}) {
    const PairAnswer answer = collide(paraboloid(0.9, 0.7, -depth), plane, {});
    ASSERT_EQ(answer.contacts.size(), 1u) << depth;
    const PairContact& contact = answer.contacts[0];
    EXPECT_NEAR(contact.depth_m, depth, exact_m);
    EXPECT_LT((contact.normal - Vector3(0, 0, 1)).norm(), exact_normal);
    EXPECT_LT((contact.pair.first_m - Vector3(0, 0, -depth)).norm(), 1e-6);
    EXPECT_LT((contact.pair.second_m - Vector3::Zero()).norm(), 1e-6);
  }
}

TEST(SurfacePair, CrossedCylindersMeetOnTheirRidges) {
  const double depth = 0.01;
  const PairAnswer answer = collide(paraboloid(0.8, 0, -depth), paraboloid(0, -0.6, 0), {});
  ASSERT_EQ(answer.contacts.size(), 1u);
  EXPECT_NEAR(answer.contacts[0].depth_m, depth, exact_m);
  EXPECT_LT((answer.contacts[0].normal - Vector3(0, 0, 1)).norm(), exact_normal);
}

TEST(SurfacePair, ADeeperBowlTouchesAShallowOneAtTheBottom) {
  const double depth = 0.004;
  const PairAnswer answer = collide(paraboloid(2, 2, -depth), paraboloid(0.5, 0.5, 0), {});
  ASSERT_EQ(answer.contacts.size(), 1u);
  EXPECT_NEAR(answer.contacts[0].depth_m, depth, exact_m);
}

TEST(SurfacePair, TouchingPlanesAndVerticesCount) {
  EXPECT_TRUE(collide(paraboloid(0.9, 0.7, 0), paraboloid(0, 0, 0), {}).result.touching);
  EXPECT_TRUE(collide(paraboloid(0, 0, 0), paraboloid(0, 0, 0), {}).result.touching);
  EXPECT_FALSE(collide(paraboloid(0.9, 0.7, 2e-6), paraboloid(0, 0, 0), {}).result.touching);
  EXPECT_FALSE(collide(paraboloid(0, 0, 2e-6), paraboloid(0, 0, 0), {}).result.touching);
}

TEST(SurfacePair, KnowsHowFarApartTheyAre) {
  PairQuery query;
  query.reach_m = std::numeric_limits<double>::infinity();
  const PairAnswer answer = collide(paraboloid(0.9, 0.7, 0.25), paraboloid(-0.4, -0.3, 0), query);
  EXPECT_FALSE(answer.result.touching);
  EXPECT_NEAR(answer.result.distance_m, 0.25, exact_m);
  EXPECT_LT((answer.result.nearest.first_m - Vector3(0, 0, 0.25)).norm(), 1e-6);
  query.reach_m = 0.2;
  EXPECT_EQ(collide(paraboloid(0.9, 0.7, 0.25), paraboloid(-0.4, -0.3, 0), query).result.distance_m,
            std::numeric_limits<double>::infinity());
}

TEST(SurfacePair, TwoDentsAreTwoRegions) {
  const KnotVector along = KnotVector::clamped_uniform(2, 8).value(),
                   across = KnotVector::clamped_uniform(2, 5).value();
  ControlNet net(8, 5);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 5; ++j) {
      const bool dent = (i == 2 || i == 5) && j == 2;
      net.set_point(i, j, {i - 3.5, j - 2.0, dent ? -1.0 : 1.0});
    }
  }
  Surface plane = paraboloid(0, 0, 0);
  for (double& x : plane.net.x) x *= 10;
  for (double& y : plane.net.y) y *= 10;
  const PairAnswer answer = collide(make_surface(along, across, net).value(), plane, {}, 3);
  ASSERT_EQ(answer.contacts.size(), 2u);
  for (const PairContact& contact : answer.contacts) {
    // The peak value of a uniform quadratic basis function is 3/4 in each direction.
    EXPECT_NEAR(contact.depth_m, 2.0 * 0.75 * 0.75 - 1.0, exact_m);
    EXPECT_LT((contact.normal - Vector3(0, 0, 1)).norm(), exact_normal);
    EXPECT_LT(contact.first.u1 - contact.first.u0, 0.5);
  }
}

TEST(SurfacePair, ABoxInABoxLeavesByTheNearestWall) {
  PairQuery query;
  query.first_closed = query.second_closed = true;
  const Surface outer = box({0.5, 0.4, 0.3}, Vector3::Zero());
  const Surface inner = box({0.1, 0.1, 0.1}, {0.35, 0, 0.02});
  const PairAnswer answer = collide(inner, outer, query);
  ASSERT_TRUE(answer.result.touching && answer.result.contained);
  EXPECT_NEAR(answer.contacts[0].depth_m, 0.05 + 0.2, 1e-6);
  EXPECT_LT((answer.contacts[0].normal - Vector3(1, 0, 0)).norm(), 1e-6);
  const PairAnswer swapped = collide(outer, inner, query);
  ASSERT_TRUE(swapped.result.contained);
  EXPECT_LT((swapped.contacts[0].normal + Vector3(1, 0, 0)).norm(), 1e-6);
  // With a default query the surfaces count as open, and open surfaces have no inside.
  EXPECT_FALSE(collide(inner, outer, {}).result.touching);
  const Surface beside = box({0.1, 0.1, 0.1}, {0.7, 0, 0});
  EXPECT_FALSE(collide(beside, outer, query).result.touching);
}

// The inner body is 900 times smaller than the outer one, which has 80 x 80 control points. It is slightly
// off the centre of the outer body.
TEST(SurfacePair, ATinyBodyInAFineOneLeavesByTheNearestWall) {
  PairQuery query;
  query.first_closed = query.second_closed = true;
  const Surface outer = ellipsoid_tube(80, 80);
  Surface inner = ellipsoid_tube(8, 8);
  for (std::vector<double>* values : {&inner.net.x, &inner.net.y, &inner.net.z}) {
    for (double& value : *values) value /= 900.0;
  }
  move(inner, {0.0, 0.0, 0.004});
  const PairAnswer answer = collide(inner, outer, query);
  ASSERT_TRUE(answer.result.contained);
  EXPECT_FALSE(answer.result.overflow);
  // The inner body leaves through the nearest wall. Dense samples of the outer body give the distance of this
  // wall.
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j <= 400; ++j) {
      nearest = std::min(nearest, (position(outer, i / 400.0, j / 400.0) - Vector3(0, 0, 0.004)).norm());
    }
  }
  const double size = 0.1 / 900.0;
  EXPECT_NEAR(answer.contacts[0].depth_m, nearest, size);
}

TEST(SurfacePair, PolesMeet) {
  PairQuery query;
  query.first_closed = query.second_closed = true;
  query.reach_m = std::numeric_limits<double>::infinity();
  // The poles are 0.05 m from the centres.
  const Surface first = ellipsoid_tube(10, 8);
  EXPECT_NEAR(collide(ellipsoid_tube(9, 7, {0, 0, 0.1001}), first, query).result.distance_m, 1e-4, exact_m);
  const PairAnswer answer = collide(ellipsoid_tube(9, 7, {0, 0, 0.0999}), first, query);
  ASSERT_EQ(answer.contacts.size(), 1u);
  EXPECT_NEAR(answer.contacts[0].depth_m, 1e-4, exact_m);
  EXPECT_LT((answer.contacts[0].normal - Vector3(0, 0, 1)).norm(), 1e-5);
}

TEST(SurfacePair, WhatHasNotMovedIsNotEvaluatedAgain) {
  Random random(79);
  const Surface first = random_surface(random), second = random_surface(random);
  const NestedGrid a = make_nested_grid(first.u, first.v, 2).value();
  const NestedGrid b = make_nested_grid(second.u, second.v, 2).value();
  SurfacePairCollider collider(a, b);
  PairQuery query;
  EXPECT_GT(collider.collide(first, second, query).samples_evaluated, 0);
  const std::vector<PairContact> before = collider.contacts();
  ASSERT_FALSE(before.empty());
  EXPECT_EQ(collider.collide(first, second, query).samples_evaluated, 0);
  ASSERT_EQ(collider.contacts().size(), before.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    // The tolerance allows for the change that occurs when Newton's method restarts from its own result.
    EXPECT_NEAR(collider.contacts()[k].depth_m, before[k].depth_m, 1e-12);
    EXPECT_LT((collider.contacts()[k].pair.first_m - before[k].pair.first_m).norm(), 1e-9);
  }
}

TEST(SurfacePair, GivenSamplesAreNotEvaluatedAndTellTheSame) {
  Random random(80);
  const Surface first = random_surface(random), second = random_surface(random);
  const NestedGrid a = make_nested_grid(first.u, first.v, 2).value();
  const NestedGrid b = make_nested_grid(second.u, second.v, 2).value();
  SurfaceLevels levels(a);
  levels.begin(first);
  std::vector<double> x, y, z;
  for (int k = 0; k < a.grid.rows() * a.grid.columns(); ++k) {
    const Vector3 sample = levels.sample(k);
    x.push_back(sample.x());
    y.push_back(sample.y());
    z.push_back(sample.z());
  }
  SurfacePairCollider without(a, b), collider(a, b);
  const int of_both = without.collide(first, second, {}).samples_evaluated;
  const std::vector<PairContact> before = without.contacts();
  ASSERT_FALSE(before.empty());
  PairQuery query;
  query.first_samples = {x.data(), y.data(), z.data()};
  EXPECT_LT(collider.collide(first, second, query).samples_evaluated, of_both);
  ASSERT_EQ(collider.contacts().size(), before.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(collider.contacts()[k].depth_m, before[k].depth_m);
  }
}

// Every cell is in contact, so all cells form one region. This holds on any level at which the limit on the
// number of cell pairs stops the search.
TEST(SurfacePair, CoincidentSheetsAreOneRegionAndNothingOverflows) {
  const KnotVector knots = KnotVector::clamped_uniform(3, 40).value();
  ControlNet net(40, 40);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j)
      net.set_point(i, j, {0.1 * i, 0.1 * std::sin(0.3 * i) * std::cos(0.2 * j), 0.1 * j});
  }
  const Surface sheet = make_surface(knots, knots, net).value();
  const PairAnswer answer = collide(sheet, sheet, {}, 3);
  EXPECT_TRUE(answer.result.touching);
  EXPECT_FALSE(answer.result.overflow);
  ASSERT_EQ(answer.contacts.size(), 1u);
  EXPECT_EQ(answer.contacts[0].first.u0, 0.0);
  EXPECT_EQ(answer.contacts[0].first.u1, 1.0);
}

TEST(SurfacePair, AllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  const Surface first = paraboloid(0.9, 0.7, -0.02), second = paraboloid(0, 0, 0);
  const NestedGrid a = make_nested_grid(first.u, first.v, 3).value();
  SurfacePairCollider collider(a, a);
  const std::size_t before = allocation_count();
  collider.collide(first, second, {});
  PairQuery far;
  far.reach_m = std::numeric_limits<double>::infinity();
  collider.collide(first, second, far);
  EXPECT_EQ(allocation_count(), before);
}

// Moves one surface so that a random point of it coincides with a random point of the other surface.
TEST(SurfacePair, NoCommonPointIsMissed) {
  Random random(77);
  std::map<std::string, int> missed;
  for (int trial = 0; trial < random_cases(2'000, 50'000); ++trial) {
    RandomPair pair = random_pair(random, 0.0);
    const auto somewhere = [&](const Surface& surface) {
      return position(surface, random.uniform(surface.u.domain_start(), surface.u.domain_end()),
                      random.uniform(surface.v.domain_start(), surface.v.domain_end()));
    };
    move(pair.second, somewhere(pair.first) - somewhere(pair.second));
    const PairAnswer answer = collide(pair.first, pair.second, {}, 1);
    if (!answer.result.touching) ++missed[pair.kind];
  }
  for (const auto& [kind, count] : missed) ADD_FAILURE() << count << " missed, " << kind;
}

// Compares the distance with bounds from balls around dense samples, which are found without hulls, levels or
// triangles.
TEST(SurfacePair, AgreesWithDenseSamplesWhereTheyAreApart) {
  Random random(78);
  const int count = random_cases(50, 300);
  int apart = 0;
  for (int trial = 0; trial < count; ++trial) {
    const RandomPair pair = random_pair(random, 1.5);
    constexpr double share = 0.3, least_m = 0.05;
    const DistanceBounds bounds = reference_distance(pair.first, pair.second, share, least_m);
    if (!(bounds.low_m > 0.0)) continue;
    ++apart;
    PairQuery query;
    query.reach_m = std::numeric_limits<double>::infinity();
    const PairAnswer answer = collide(pair.first, pair.second, query, 1);
    EXPECT_FALSE(answer.result.overflow) << trial << ' ' << pair.kind;
    EXPECT_FALSE(answer.result.touching) << trial << ' ' << pair.kind;
    EXPECT_GE(answer.result.distance_m, bounds.low_m) << trial << ' ' << pair.kind;
    // The collider states a tolerance of 4e-4 m for surfaces of up to 4 m.
    EXPECT_LE(answer.result.distance_m, bounds.high_m + 4e-4) << trial << ' ' << pair.kind;
  }
  EXPECT_GT(apart, count / 5);
}

}  // namespace
}  // namespace spoonbill
