// Tests that a collider reuses data of its previous query to save work, and that this changes no result.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/surfaces/random_pairs.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Tolerance of a depth that the collider guarantees, in metres.
constexpr double deepest_m = 2e-5;

Vector3 random_point(Random& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

// The sphere moves a little from query to query, and to a random position at every tenth query. The surface
// changes a little at every third query.
TEST(Coherence, ASphereOnItsWayIsFoundAsByAColliderThatKnowsNothing) {
  Random random(301);
  int found = 0;
  for (int round = 0; round < 20; ++round) {
    Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
    SurfaceCollider collider(nested);
    const auto anywhere = [&] {
      return evaluate(surface, random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)).position_m;
    };
    Vector3 centre = anywhere();
    for (int step = 0; step < 40; ++step) {
      centre += random_point(random, -0.01, 0.01);
      if (step % 10 == 9) centre = anywhere();
      if (step % 3 == 0) surface.net.z[surface.net.size() / 2] += 0.002;
      const ToolShape tool = ToolShape::sphere(centre, 0.1);
      SurfaceCollider fresh(nested);
      const CollisionResult one = collider.collide(surface, tool, 0.05, false);
      const CollisionResult other = fresh.collide(surface, tool, 0.05, false);
      ASSERT_FALSE(one.overflow);
      EXPECT_NEAR(one.nearest.depth_m, other.nearest.depth_m, deepest_m) << round << ' ' << step;
      EXPECT_EQ(collider.near_samples().size(), fresh.near_samples().size()) << round << ' ' << step;
      found += other.found;
    }
  }
  EXPECT_GT(found, 100);
}

TEST(Coherence, WhatWasNearestLastSparesSamples) {
  Surface tube = ellipsoid_tube(12, 30);
  const NestedGrid nested = make_nested_grid(tube.u, tube.v, 3).value();
  SurfaceCollider collider(nested);
  int with_last = 0, without = 0;
  for (int step = 0; step < 50; ++step) {
    tube.net.x[tube.net.size() / 2] += 1e-6;
    const ToolShape tool = ToolShape::sphere({0.0, 0.017, -0.02 + 0.0005 * step}, 0.006);
    SurfaceCollider fresh(nested);
    with_last += collider.collide(tube, tool, 0.0, true).samples_evaluated;
    without += fresh.collide(tube, tool, 0.0, true).samples_evaluated;
  }
  EXPECT_LT(with_last, without);
}

TEST(Coherence, ASurfaceThatDidNotMoveIsNotEvaluatedAgain) {
  Random random(302);
  Surface surface = random_surface(random);
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
  SurfaceCollider collider(nested);
  const ToolShape tool = ToolShape::sphere(evaluate(surface, 0.4, 0.6).position_m, 0.05);
  EXPECT_GT(collider.collide(surface, tool, 0.0, false).samples_evaluated, 0);
  EXPECT_EQ(collider.collide(surface, tool, 0.0, false).samples_evaluated, 0);
  surface.net.z[0] += 1e-9;
  EXPECT_GT(collider.collide(surface, tool, 0.0, false).samples_evaluated, 0);
}

// Two random surfaces drift through each other. At each step, a collider that starts from its last result and
// a new collider must agree on whether the surfaces touch.
TEST(Coherence, SurfacesThatDriftTouchAsForAColliderThatKnowsNothing) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Random random(303);
  int touching = 0, apart = 0;
  const int rounds = is_full_run() ? 6 : 1;
  for (int round = 0; round < rounds; ++round) {
    Surface first = random_surface(random), second = random_surface(random);
    const NestedGrid a = make_nested_grid(first.u, first.v, 2).value();
    const NestedGrid b = make_nested_grid(second.u, second.v, 2).value();
    SurfacePairCollider collider(a, b);
    for (double& y : first.net.y) y += 0.6;
    for (int step = 0; step < 24; ++step) {
      for (double& y : first.net.y) y -= 0.025;
      SurfacePairCollider fresh(a, b);
      PairQuery query;
      query.reach_m = 0.2;
      const PairResult one = collider.collide(first, second, query);
      const PairResult other = fresh.collide(first, second, query);
      EXPECT_EQ(one.touching, other.touching) << round << ' ' << step;
      EXPECT_EQ(collider.contacts().size(), fresh.contacts().size()) << round << ' ' << step;
      touching += other.touching;
      // The error of a distance is at most 1e-4 of the distance or of the smaller surface's size, whichever
      // is larger.
      constexpr double nearest_m = 2e-4;
      if (other.touching || !(other.distance_m < query.reach_m - nearest_m)) continue;
      ++apart;
      EXPECT_NEAR(one.distance_m, other.distance_m, nearest_m) << round << ' ' << step;
    }
  }
  EXPECT_GT(touching, 3 * rounds);
  EXPECT_GT(apart, 3 * rounds);
}

}  // namespace
}  // namespace spoonbill
