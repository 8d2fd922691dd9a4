#include "engine/collision/solids/surface_collider.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Returns a flat clamped cubic sheet over the unit square with 8 x 8 control points, of which the central
// four are raised to z = 3.
Surface spike() {
  const KnotVector knots = KnotVector::clamped_uniform(3, 8).value();
  ControlNet net(8, 8);
  const double abscissae[8] = {0.0, 1.0 / 15, 0.2, 0.4, 0.6, 0.8, 14.0 / 15, 1.0};
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const bool centre = (i == 3 || i == 4) && (j == 3 || j == 4);
      net.set_point(i, j, {abscissae[i], abscissae[j], centre ? 3.0 : 0.0});
    }
  }
  return make_surface(knots, knots, net).value();
}

// The sphere passes through the corners of the whole sheet, as if the sheet were one cell. The sheet bulges
// out of it by at most the largest bound of all elements (pairs of knot spans).
TEST(SurfaceBounds, ASpikeEscapesTheSphereOfItsCornersButNotTheBoundedOne) {
  const Surface surface = spike();
  const Vector3 peak = evaluate(surface, 0.5, 0.5).position_m;
  EXPECT_NEAR(peak.z(), 2.755208, 1e-6);
  const Vector3 centre(0.5, 0.5, 0.0);
  const double of_corners = std::sqrt(0.5);
  EXPECT_GT((peak - centre).norm(), of_corners);
  SurfaceBounds bounds(surface.u, surface.v);
  bounds.update(surface.net);
  double bulge = 0.0;
  for (int i = 0; i < bounds.elements_u(); ++i) {
    for (int j = 0; j < bounds.elements_v(); ++j) bulge = std::max(bulge, bounds.bulge(i, j, 1.0, 1.0));
  }
  EXPECT_LE((peak - centre).norm(), of_corners + bulge);
}

TEST(SurfaceCollider, FindsTheSpikeBetweenSparseSamples) {
  const Surface surface = spike();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 0).value();
  SurfaceCollider collider(nested);
  const CollisionResult hit = collider.collide(surface, ToolShape::sphere({0.5, 0.5, 2.8}, 0.05), 0.0, false);
  EXPECT_TRUE(hit.found);
  EXPECT_NEAR(hit.nearest.depth_m, 0.05 - (2.8 - 2.7552083333), 1e-9);
  EXPECT_FALSE(collider.collide(surface, ToolShape::sphere({0.5, 0.5, 2.8}, 0.04), 0.0, false).found);
}

TEST(SurfaceCollider, SpheresCoverTheirPatches) {
  Random random(21);
  for (int trial = 0; trial < 60; ++trial) {
    const Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
    SurfaceCollider collider(nested);
    (void)collider.collide(surface, ToolShape::sphere(Vector3::Zero(), 10.0), 0.0, false);
    const Grid& grid = nested.grid;
    for (int level = 0; level <= 2; ++level) {
      const int step = 1 << (2 - level);
      const int i = random.integer(0, (grid.rows() - 1) / step - 1) * step;
      const int j = random.integer(0, (grid.columns() - 1) / step - 1) * step;
      const CoverSphere cover = collider.levels().cover({i, j, level});
      for (int s = 0; s < 200; ++s) {
        const double u = random.uniform(grid.u.parameters[i], grid.u.parameters[i + step]);
        const double v = random.uniform(grid.v.parameters[j], grid.v.parameters[j + step]);
        const double distance = (evaluate(surface, u, v).position_m - cover.centre).norm();
        ASSERT_LE(distance, cover.radius * (1.0 + 1e-12)) << "trial " << trial << " level " << level;
      }
    }
  }
}

// Returns the smallest distance of dense samples from the tool, refined around the best sample.
double dense_distance(const Surface& surface, const ToolShape& tool) {
  constexpr int count = 160;
  double best = 1e300, best_u = 0.0, best_v = 0.0;
  double half_u = (surface.u.domain_end() - surface.u.domain_start()) / count;
  double half_v = (surface.v.domain_end() - surface.v.domain_start()) / count;
  const auto offer = [&](double u, double v) {
    const double distance = tool.distance(evaluate(surface, u, v).position_m);
    if (distance >= best) return;
    best = distance;
    best_u = u;
    best_v = v;
  };
  for (int i = 0; i <= count; ++i) {
    for (int j = 0; j <= count; ++j)
      offer(surface.u.domain_start() + i * half_u, surface.v.domain_start() + j * half_v);
  }
  for (int round = 0; round < 12; ++round, half_u *= 0.5, half_v *= 0.5) {
    const double u = best_u, v = best_v;
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j)
        offer(surface.u.into_domain(u + i * half_u), surface.v.into_domain(v + j * half_v));
    }
  }
  return best;
}

// Compares random surfaces of every kind with spheres, points and half-spaces near them. Up to its tolerance,
// the collider's distance must not be larger than that of dense samples, and its point must be on the
// surface.
TEST(SurfaceCollider, AgreesWithDenseSampling) {
  const int trials = random_cases(150, 4000);
  Random random(5);
  for (int trial = 0; trial < trials; ++trial) {
    const Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 1).value();
    SurfaceCollider collider(nested);
    const Vector3 at(random.uniform(-0.3, 1.3), random.uniform(-0.3, 1.3), random.uniform(-0.6, 0.6));
    const Vector3 normal =
        Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)).normalized();
    const ToolShape tool = trial % 3 == 0   ? ToolShape::half_space(at, normal)
                           : trial % 3 == 1 ? ToolShape::sphere(at, random.uniform(0.01, 0.3))
                                            : ToolShape::sphere(at, 0.0);
    const double reference = dense_distance(surface, tool);
    const CollisionResult result = collider.collide(surface, tool, 0.0, false);
    // The collider guarantees the distance to 2e-5 m. If it finds nothing, it guarantees only that no depth
    // exceeds 1e-6 m.
    if (result.found || reference < -1e-6) {
      ASSERT_TRUE(result.found) << trial << " distance " << reference;
      EXPECT_LE(-result.nearest.depth_m, reference + 2e-5) << trial;
    }
    const Vector3 on_surface = evaluate(surface, result.nearest.u, result.nearest.v).position_m;
    EXPECT_LT((on_surface - result.nearest.point_m).norm(), 1e-12);
    EXPECT_FALSE(result.overflow) << trial;
  }
}

TEST(SurfaceCollider, KnowsTheInsideOfAClosedBody) {
  const Surface surface = ellipsoid_tube(12, 12);
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 1).value();
  SurfaceCollider collider(nested);
  const double outside = 0.013;
  const CollisionResult apart =
      collider.collide(surface, ToolShape::sphere({0.0, outside, 0.0}, 0.0), 0.0, true);
  EXPECT_FALSE(apart.found);
  const double top = outside + apart.nearest.depth_m;  // height of the surface
  const CollisionResult inside =
      collider.collide(surface, ToolShape::sphere({0.0, 0.004, 0.0}, 0.0), 0.0, true);
  EXPECT_TRUE(inside.found);
  EXPECT_NEAR(inside.nearest.depth_m, top - 0.004, 1e-9);
  EXPECT_GT(inside.nearest.normal.y(), 0.9);
  // A sphere that is completely inside and touches nothing is found too.
  EXPECT_TRUE(collider.collide(surface, ToolShape::sphere({0.0, 0.0, 0.0}, 0.001), 0.0, true).found);
}

TEST(SurfaceCollider, SphereOnAFlatSheetMeetsTheClosedForm) {
  Surface surface = spike();
  for (double& z : surface.net.z) z = 0.0;
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
  SurfaceCollider collider(nested);
  const CollisionResult result =
      collider.collide(surface, ToolShape::sphere({0.31, 0.62, 0.095}, 0.1), 0.01, false);
  ASSERT_TRUE(result.found);
  EXPECT_NEAR(result.nearest.depth_m, 0.005, 1e-12);
  EXPECT_NEAR(result.nearest.u, 0.31, 1e-9);  // the sheet's parameters are its coordinates
  EXPECT_NEAR(result.nearest.v, 0.62, 1e-9);
  EXPECT_NEAR(result.nearest.normal.z(), 1.0, 1e-12);
  for (const NearSample& sample : collider.near_samples()) EXPECT_LE(sample.distance_m, 0.01);
  EXPECT_GE(collider.near_samples().size(), 4u);
}

TEST(SurfaceCollider, AllocatesNothing) {
  const Surface surface = spike();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider collider(nested);
  const std::size_t before = allocation_count();
  for (int i = 0; i < 20; ++i) {
    (void)collider.collide(surface, ToolShape::sphere({0.5, 0.5, 0.1 * i}, 0.3), 0.05, true);
  }
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
