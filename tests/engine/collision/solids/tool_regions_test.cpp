#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/collision/solids/implicit_shapes.h"
#include "engine/collision/solids/surface_collider.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/collision/surfaces/sheets.h"

namespace spoonbill {
namespace {

using Regions = std::vector<ToolContactRegion>;

struct Asked {
  explicit Asked(const Surface& surface, int levels = 2)
      : nested(make_nested_grid(surface.u, surface.v, levels).value()), collider(nested) {}

  Regions regions(const Surface& surface, const ToolShape& tool) {
    result = collider.collide(surface, tool, 0.0, false);
    return collider.find_contact_regions(tool);
  }

  NestedGrid nested;
  SurfaceCollider collider;
  CollisionResult result;
};

const Quaternion along_x(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitZ()));

// Returns a sheet with three crests: y = 0.01 cos(2 pi x / 0.08), approximated by control points.
Surface waves() {
  Surface sheet = quadric_sheet(0.1, 0.0, 0.0, 24);
  for (std::size_t k = 0; k < sheet.net.size(); ++k) {
    sheet.net.y[k] = 0.01 * std::cos(sheet.net.x[k] * 2.0 * std::numbers::pi / 0.08);
  }
  return sheet;
}

TEST(ToolRegions, ARodOverWavesTouchesEachCrest) {
  const Surface sheet = waves();
  Asked asked(sheet);
  const double crest = position(sheet, 0.5, 0.5).y();
  const auto rod = make_signed_distance(CapsuleShape{0.01, 0.095});
  const ToolShape tool = ToolShape::solid(*rod, {{0.0, crest + 0.01 - 0.001, 0.0}, along_x});
  const Regions regions = asked.regions(sheet, tool);
  ASSERT_EQ(regions.size(), 3u);  // one per crest, at x = -80, 0 and 80 mm
  EXPECT_FALSE(asked.collider.regions_overflow());
  EXPECT_NEAR(regions[0].deepest.depth_m, asked.result.nearest.depth_m, 2e-5);
  std::vector<double> places;
  for (const ToolContactRegion& region : regions) {
    places.push_back(region.deepest.point_m.x());
    // The crests differ slightly, depending on the positions of the control points.
    EXPECT_NEAR(region.deepest.depth_m, 0.001, 1e-4);
    EXPECT_NEAR(region.deepest.normal.y(), 1.0, 1e-3);
    EXPECT_LE(region.range.u0, region.deepest.u);
    EXPECT_GE(region.range.u1, region.deepest.u);
    EXPECT_LE(region.range.v0, region.deepest.v);
    EXPECT_GE(region.range.v1, region.deepest.v);
    EXPECT_LT(region.range.v1 - region.range.v0, 0.3);
    EXPECT_NEAR(region.deepest.tangent_u.z(), 1.0, 1e-3);
  }
  std::sort(places.begin(), places.end());
  EXPECT_NEAR(places[0], -0.08, 2e-3);
  EXPECT_NEAR(places[1], 0.0, 2e-3);
  EXPECT_NEAR(places[2], 0.08, 2e-3);
}

// Every sample inside the tool is in the range of a region whose deepest point is at least as deep as the
// sample, up to the tolerance. Each region's deepest point is inside the tool.
TEST(ToolRegions, HoldEverySampleInTheTool) {
  Random random(61);
  for (int trial = 0; trial < 60; ++trial) {
    const Surface surface = random_surface(random);
    Asked asked(surface, 1);
    const double x = random.uniform(-0.4, 0.4), y = random.uniform(-0.3, 0.3), z = random.uniform(-0.4, 0.4);
    const ToolShape tool = ToolShape::sphere({x, y, z}, random.uniform(0.05, 0.3));
    const Regions regions = asked.regions(surface, tool);
    EXPECT_EQ(regions.empty(), !asked.result.found) << trial;
    for (int s = 0; s < 2000; ++s) {
      const double u = random.uniform(surface.u.domain_start(), surface.u.domain_end());
      const double v = random.uniform(surface.v.domain_start(), surface.v.domain_end());
      const double distance = tool.distance(position(surface, u, v));
      if (distance > 0.0) continue;
      const bool held = std::any_of(regions.begin(), regions.end(), [&](const ToolContactRegion& region) {
        return region.range.u0 <= u && u <= region.range.u1 && region.range.v0 <= v && v <= region.range.v1 &&
               region.deepest.depth_m >= -distance - 2e-5;
      });
      ASSERT_TRUE(held) << trial << " at " << u << ", " << v;
    }
    for (const ToolContactRegion& region : regions) {
      EXPECT_LE(tool.distance(region.deepest.point_m), touch_tolerance_m) << trial;
    }
  }
}

// Contact across the seam of the periodic direction is one region. Its range is the whole period.
TEST(ToolRegions, HangTogetherOverASeam) {
  const Surface tube = round_tube(0.02, 0.06);
  Asked asked(tube);
  const Vector3 seam = position(tube, 0.0, 0.3);
  const auto ball = make_signed_distance(SphereShape{0.004});
  const Vector3 out = unit_normal(tube, 0.0, 0.3);
  const Regions regions =
      asked.regions(tube, ToolShape::solid(*ball, {seam + 0.003 * out, Quaternion::Identity()}));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_EQ(regions[0].range.u0, 0.0);
  EXPECT_EQ(regions[0].range.u1, 1.0);
  EXPECT_LT(regions[0].range.v1 - regions[0].range.v0, 1.0);
  EXPECT_NEAR(regions[0].deepest.depth_m, 0.001, 1e-9);
}

TEST(ToolRegions, APoleIsOneRegion) {
  const Surface body = ellipsoid_tube(12, 12);
  Asked asked(body);
  const auto box = make_signed_distance(BoxShape{Vector3::Constant(0.01)});
  const Regions regions =
      asked.regions(body, ToolShape::solid(*box, {{0.0, 0.0, 0.05 + 0.0095}, Quaternion::Identity()}));
  ASSERT_EQ(regions.size(), 1u);
  EXPECT_NEAR(regions[0].deepest.depth_m, 5e-4, 1e-9);
}

TEST(ToolRegions, AreNoneWhereNothingTouches) {
  const Surface sheet = waves();
  Asked asked(sheet);
  EXPECT_TRUE(asked.regions(sheet, ToolShape::sphere({0.0, 0.1, 0.0}, 0.05)).empty());
}

// A sphere gives the same regions as ToolShape::sphere() and as a general solid.
TEST(ToolRegions, OfASphereAndOfItsSolidAreAlike) {
  const Surface sheet = waves();
  Asked asked(sheet);
  const auto ball = make_signed_distance(SphereShape{0.05});
  const Vector3 at(0.04, 0.04, 0.01);
  const Regions plain = asked.regions(sheet, ToolShape::sphere(at, 0.05));
  const Regions solid = asked.regions(sheet, ToolShape::solid(*ball, {at, Quaternion::Identity()}));
  ASSERT_EQ(plain.size(), solid.size());
  ASSERT_FALSE(plain.empty());
  for (std::size_t k = 0; k < plain.size(); ++k) {
    EXPECT_NEAR(plain[k].deepest.depth_m, solid[k].deepest.depth_m, 1e-9);
  }
}

}  // namespace
}  // namespace spoonbill
