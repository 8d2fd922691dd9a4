#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "engine/bspline/surface.h"
#include "engine/collision/solids/implicit_shapes.h"
#include "engine/collision/solids/surface_collider.h"
#include "loops.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

constexpr double bent_side_m = 0.1, bent_hole_radius_m = 0.012, bent_tool_radius_m = 0.008;
constexpr int hole_corners = 400;

// Returns a sheet whose parameters are proportional to x and y. If `bend_m` is 0, the sheet is flat and its
// normals are along z. Otherwise, the heights of its control points vary by up to 6 `bend_m`.
Surface bent_sheet(double bend_m = 0.0) {
  const KnotVector knots = KnotVector::clamped_uniform(3, 8).value();
  const double abscissae[8] = {0.0, 1.0 / 15, 0.2, 0.4, 0.6, 0.8, 14.0 / 15, 1.0};
  ControlNet net(8, 8);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      net.set_point(i, j,
                    {bent_side_m * abscissae[i], bent_side_m * abscissae[j], bend_m * ((i * 5 + j * 3) % 7)});
    }
  }
  return make_surface(knots, knots, net).value();
}

// Returns a clockwise polygon with its corners on the circle of the hole.
TrimLoop hole(const Surface& surface) {
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < hole_corners; ++k) {
    const double angle = -2.0 * std::numbers::pi * k / hole_corners;
    points.emplace_back(0.5 + bent_hole_radius_m / bent_side_m * std::cos(angle),
                        0.5 + bent_hole_radius_m / bent_side_m * std::sin(angle));
  }
  return polygon_loop(surface.u, surface.v, points);
}

std::shared_ptr<const TrimmedArea> shared_area_of(const Surface& surface,
                                                  const std::vector<TrimLoop>& loops) {
  return std::make_shared<const TrimmedArea>(TrimmedArea::make(surface.u, surface.v, loops).value());
}

// Sagitta: the largest distance between the circle and the polygon's edges.
const double sagitta_m = bent_hole_radius_m * (1.0 - std::cos(std::numbers::pi / hole_corners));

TEST(TrimmedCollision, ASphereMeetsTheSheetBesideAHoleAndTheRimAboveIt) {
  const Surface surface = bent_sheet();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider collider(nested, shared_area_of(surface, {hole(surface)}));
  for (const double height : {0.001, 0.004, 0.01}) {
    for (const double aside : {0.0, 0.002, 0.007, 0.0119, 0.0121, 0.02}) {
      const Vector3 centre(0.05 + 0.8 * aside, 0.05 + 0.6 * aside, height);
      const CollisionResult result =
          collider.collide(surface, ToolShape::sphere(centre, bent_tool_radius_m), 1.0, false);
      ASSERT_TRUE(result.found);
      const double to_rim = std::max(0.0, bent_hole_radius_m - aside);
      EXPECT_NEAR(-result.nearest.depth_m, std::hypot(to_rim, height) - bent_tool_radius_m, sagitta_m + 1e-9)
          << height << " " << aside;
      for (const NearSample& near : collider.near_samples()) {
        const Vector3 at = collider.levels().sample(near.index);
        EXPECT_GE((at - Vector3(0.05, 0.05, 0.0)).norm(), bent_hole_radius_m - sagitta_m);
      }
    }
  }
}

TEST(TrimmedCollision, ASphereThatFitsPassesThroughAHole) {
  const Surface surface = bent_sheet();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider trimmed(nested, shared_area_of(surface, {hole(surface)})), whole(nested);
  for (double height = 0.02; height > -0.02; height -= 0.001) {
    const ToolShape tool = ToolShape::sphere({0.051, 0.05, height}, bent_tool_radius_m);
    EXPECT_FALSE(trimmed.collide(surface, tool, 0.002, false).found) << height;
    EXPECT_EQ(whole.collide(surface, tool, 0.002, false).found, std::abs(height) < 0.01) << height;
  }
}

// The distance must agree with the distance of the nearest of many sampled kept points. It may be less by up
// to `between_m`, because the surface between samples may be nearer.
TEST(TrimmedCollision, AgreesWithDenseSamplingOnBentSheets) {
  const Surface surface = bent_sheet(0.004);
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  const TrimLoop outer = round_loop(surface.u, surface.v, {0.5, 0.5}, 0.45, 8, false);
  const TrimLoop inner = round_loop(surface.u, surface.v, {0.45, 0.55}, 0.2, 5, true);
  const auto area = shared_area_of(surface, {outer, inner});
  SurfaceCollider collider(nested, area);
  constexpr int count = 700;
  std::vector<Vector3> kept;
  double longest_m = 0.0;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double u = (i + 0.5) / count, v = (j + 0.5) / count;
      if (!area->contains(u, v)) continue;
      const SurfacePoint at = evaluate(surface, u, v);
      kept.push_back(at.position_m);
      longest_m = std::max(longest_m, at.du.norm() + at.dv.norm());
    }
  }
  // The bound is half a cell's diagonal, and as much again beside a loop, where the nearest kept sample may
  // be in the next cell.
  const double between_m = longest_m / count;
  Random random(5);
  for (int k = 0; k < 60; ++k) {
    const Vector3 centre(random.uniform(0.0, bent_side_m), random.uniform(0.0, bent_side_m),
                         random.uniform(-0.02, 0.04));
    const CollisionResult result = collider.collide(surface, ToolShape::sphere(centre, 0.0), 1.0, false);
    double nearest = std::numeric_limits<double>::max();
    for (const Vector3& point : kept) nearest = std::min(nearest, (point - centre).norm());
    ASSERT_TRUE(result.found);
    EXPECT_LE(-result.nearest.depth_m, nearest + 1e-9)
        << "a nearer point was missed at " << centre.transpose();
    EXPECT_GE(-result.nearest.depth_m, nearest - between_m) << centre.transpose();
  }
}

TEST(TrimmedCollision, ASolidMeetsTheRimToo) {
  const Surface surface = bent_sheet();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider collider(nested, shared_area_of(surface, {hole(surface)}));
  // The corners of the larger box, whose half sides are 9 mm, are 12.73 mm from the centre and so reach the
  // rim. Those of the smaller box do not.
  const auto box = make_signed_distance(ImplicitShape(BoxShape{{0.009, 0.009, 0.002}}));
  const auto thin = make_signed_distance(ImplicitShape(BoxShape{{0.008, 0.008, 0.002}}));
  const Pose over{{0.05, 0.05, 0.0}, Eigen::Quaterniond::Identity()};
  EXPECT_TRUE(collider.collide(surface, ToolShape::solid(*box, over), 0.0, false).found);
  EXPECT_FALSE(collider.collide(surface, ToolShape::solid(*thin, over), 0.0, false).found);
  const CollisionResult beside = collider.collide(surface, ToolShape::solid(*thin, over), 0.01, false);
  ASSERT_TRUE(beside.found);
  // The corner of the smaller box is at 11.3137 mm and the rim at 12 mm.
  EXPECT_NEAR(-beside.nearest.depth_m, bent_hole_radius_m - 0.008 * std::numbers::sqrt2, sagitta_m + 1e-6);
}

TEST(TrimmedCollision, RegionsAreOfWhatIsThere) {
  const Surface surface = bent_sheet();
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider trimmed(nested, shared_area_of(surface, {hole(surface)}));
  const ToolShape tool = ToolShape::sphere({0.05, 0.05, 0.0}, 0.0125);
  ASSERT_TRUE(trimmed.collide(surface, tool, 0.0, false).found);
  const auto& regions = trimmed.find_contact_regions(tool);
  ASSERT_EQ(regions.size(), 1u) << "a ring about the hole";
  EXPECT_NEAR(regions[0].deepest.depth_m, 0.0005, sagitta_m + 1e-9);
  EXPECT_NEAR(std::hypot(regions[0].deepest.point_m.x() - 0.05, regions[0].deepest.point_m.y() - 0.05),
              bent_hole_radius_m, sagitta_m + 1e-9);
}

TEST(TrimmedCollision, AllocatesNothing) {
  const Surface surface = bent_sheet(0.001);
  const NestedGrid nested = make_nested_grid(surface.u, surface.v, 3).value();
  SurfaceCollider collider(nested, shared_area_of(surface, {hole(surface)}));
  const auto before = allocation_count();
  for (int k = 0; k < 50; ++k) {
    collider.collide(surface, ToolShape::sphere({0.03 + 0.001 * k, 0.05, 0.004}, 0.02), 0.002, false);
  }
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
