// Tests that the bowl of a spoon is found: its rim, its frame and its sizes; and that it can be varied.
#include "engine/trial/bowl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "engine/scene/place_body.h"
#include "engine/trial/bowl_change.h"
#include "engine/trial/rim.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

Body bowl_of(const BowlSize& size) {
  Body bowl = stock_body("bowl", size, Vector3::Zero(), bundled_material("steel-304"), 300);
  bowl.kind = BodyKind::fixed;
  return bowl;
}

Body turned(Body body, const Vector3& axis, double angle_deg) {
  move_body({Vector3::Zero(), Quaternion(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, axis))},
            body);
  return body;
}

// The ridge is where the rounded rim is highest: half the rim's thickness inside its outer edge, and a little
// more, because the wall leans outwards.
TEST(Bowl, IsFoundFromItsRidge) {
  for (const double rim_m : {0.0005, 0.001, 0.002}) {
    const BowlSize size{0.06, 0.04, 0.01, rim_m};
    const auto bowl = find_bowl(bowl_of(size), Vector3::UnitY());
    ASSERT_TRUE(bowl.ok()) << rim_m;
    EXPECT_NEAR(bowl->length_m, size.length_m - rim_m, 0.5e-3) << rim_m;
    EXPECT_NEAR(bowl->width_m, size.width_m - rim_m, 0.5e-3) << rim_m;
    EXPECT_NEAR(bowl->depth_m, size.depth_m, 0.1e-3) << rim_m;
    EXPECT_GT(bowl->normal.y(), 0.9999) << rim_m;
    EXPECT_GT(bowl->front.x(), 0.9999) << rim_m;
    EXPECT_EQ(bowl->rim.size(), static_cast<std::size_t>(bowl_rim_corners));
  }
}

// The edge of the rim is a little inside the outer sizes, because the wall leans outwards below it.
TEST(Bowl, TakesAKnownRim) {
  const BowlSize size{0.06, 0.04, 0.01, 0.002};
  Body body = bowl_of(size);
  body.rim = bowl_shape(size)->rim;
  const auto bowl = find_bowl(body, Vector3::UnitY());
  ASSERT_TRUE(bowl.ok());
  EXPECT_NEAR(bowl->length_m, size.length_m, 0.75e-3);
  EXPECT_NEAR(bowl->width_m, size.width_m, 0.75e-3);
}

TEST(Bowl, HasAFrameThatTurnsWithTheBody) {
  const Body level = bowl_of({0.06, 0.04, 0.01, 0.001});
  const auto pitched = find_bowl(turned(level, Vector3::UnitZ(), 12.0), Vector3::UnitY());
  ASSERT_TRUE(pitched.ok());
  EXPECT_NEAR(pitched->pitch_deg(Vector3::UnitY()), 12.0, 0.3);
  // A positive turn about the tilt axis lifts the front.
  EXPECT_GT(pitched->tilt_axis().cross(pitched->front).y(), 0.9);
  const auto aside = find_bowl(turned(level, Vector3::UnitY(), 90.0), Vector3::UnitY());
  ASSERT_TRUE(aside.ok());
  EXPECT_GT(aside->front.z(), 0.999);
  EXPECT_NEAR(aside->length_m, 0.059, 0.5e-3);
}

// The corners run counter-clockwise seen from above, from the front.
TEST(Bowl, HasARimThatBeginsAtTheFront) {
  const Body body = bowl_of({0.06, 0.04, 0.01, 0.001});
  const auto bowl = find_bowl(body, Vector3::UnitY());
  ASSERT_TRUE(bowl.ok());
  const auto corner = [&](int k) -> Vector3 {
    const Vector2& at = bowl->rim[static_cast<std::size_t>(k)];
    return position(body.surface, at.x(), at.y()) - bowl->centre_m;
  };
  EXPECT_GT(corner(0).dot(bowl->front), 0.029);
  EXPECT_GT(corner(bowl_rim_corners / 4).dot(bowl->left()), 0.019);
  EXPECT_LT(corner(bowl_rim_corners / 2).dot(bowl->front), -0.029);
}

// The shipped spoons are merged from a bowl of 60 x 38 mm, 8 mm deep, and a handle, which may rise from the
// bowl, as that of the bent spoon does. The bridge to the handle may move the back of the rim.
TEST(Bowl, IsFoundOnMergedSpoons) {
  for (const char* const name : {"spoon-original", "spoon-bent", "spoon-grip-bulge", "spoon-thick"}) {
    const Scene scene = bundled_scene(name);
    const auto bowl = find_bowl(scene.bodies.front(), Vector3::UnitY());
    ASSERT_TRUE(bowl.ok()) << name;
    EXPECT_NEAR(bowl->length_m, 0.060, 0.004) << name;
    EXPECT_NEAR(bowl->width_m, 0.0365, 0.001) << name;
    EXPECT_NEAR(bowl->depth_m, 0.008, 0.0005) << name;
    EXPECT_NEAR(bowl->centre_m.x(), 0.133, 0.003) << name;
    EXPECT_GT(bowl->front.x(), 0.99) << name;
    EXPECT_GT(bowl->normal.y(), 0.99) << name;
  }
}

TEST(Bowl, IsNotFoundWhereNothingHoldsWater) {
  const Body handle = bundled_scene("spoon-handle").bodies.front();
  EXPECT_EQ(find_bowl(handle, Vector3::UnitY()).error().code, ErrorCode::missing);
  const Body upside_down = turned(bowl_of({0.06, 0.04, 0.01, 0.001}), Vector3::UnitX(), 180.0);
  EXPECT_EQ(find_bowl(upside_down, Vector3::UnitY()).error().code, ErrorCode::missing);
  // A rim on a ball is known, but nothing is below it.
  Body ball = stock_body("ball", SphereSize{0.02}, Vector3::Zero(), bundled_material("abs"), 300);
  ball.rim = {{0.0, 0.7}, {0.25, 0.7}, {0.5, 0.7}, {0.75, 0.7}};
  EXPECT_FALSE(find_bowl(ball, Vector3::UnitY()).ok());
  Body mesh;
  mesh.mesh = std::make_shared<const CleanMesh>();
  EXPECT_EQ(find_bowl(mesh, Vector3::UnitY()).error().code, ErrorCode::unsupported);
}

TEST(BowlChange, ScalesDepthAndWidthButNotTheHandle) {
  const Body spoon = bundled_scene("spoon-original").bodies.front();
  const Bowl bowl = find_bowl(spoon, Vector3::UnitY()).value();
  Body changed = spoon;
  change_bowl(bowl, {0.5, 1.2, 1.0}, changed.surface);
  const auto after = find_bowl(changed, Vector3::UnitY());
  ASSERT_TRUE(after.ok());
  EXPECT_NEAR(after->depth_m, 0.5 * bowl.depth_m, 0.2e-3);
  EXPECT_NEAR(after->width_m, 1.2 * bowl.width_m, 0.5e-3);
  const auto tip = [](const Body& body, const Bowl& found) {
    return position(body.surface, found.rim[0].x(), found.rim[0].y());
  };
  EXPECT_LT((tip(changed, after.value()) - tip(spoon, bowl)).norm(), 0.75e-3);
  for (int i = 0; i < spoon.surface.net.rows; ++i) {
    for (int j = 0; j < spoon.surface.net.columns; ++j) {
      const Vector3 point = spoon.surface.net.point(i, j);
      if (point.x() > 0.08) continue;
      EXPECT_EQ(changed.surface.net.point(i, j), point);
    }
  }
}

// With a quarter of the depth left, the inside is lower than that of a paraboloid if the bottom is flatter.
TEST(BowlChange, MakesTheBottomFlatter) {
  Body body = bowl_of({0.06, 0.04, 0.01, 0.001});
  const Bowl bowl = find_bowl(body, Vector3::UnitY()).value();
  const double height_before = bowl.centre_m.y() - bowl.depth_m;
  change_bowl(bowl, {1.0, 1.0, 0.5}, body.surface);
  const auto after = find_bowl(body, Vector3::UnitY());
  ASSERT_TRUE(after.ok());
  EXPECT_NEAR(after->depth_m, bowl.depth_m, 0.3e-3);
  EXPECT_NEAR(after->centre_m.y() - after->depth_m, height_before, 0.3e-3);
  const Vector3 halfway = position(body.surface, 0.75, 0.75);
  const Vector3 halfway_before = position(bowl_of({0.06, 0.04, 0.01, 0.001}).surface, 0.75, 0.75);
  EXPECT_LT(halfway.y(), halfway_before.y() - 0.5e-3);
}

TEST(Rim, HasAMargin) {
  const BowlSize size{0.06, 0.04, 0.01, 0.001};
  Body body = bowl_of(size);
  const auto rim = Rim::on_surface(body.surface, bowl_shape(size)->rim, Vector3::UnitY());
  ASSERT_TRUE(rim);
  const double half_width_m = std::abs(position(body.surface, 0.0, 0.5).z()),
               half_length_m = position(body.surface, 0.0, 1.0).x();
  EXPECT_NEAR(rim->margin_m(Vector3::Zero()), half_width_m, 1e-5);
  EXPECT_NEAR(rim->margin_m({0.035, 0.02, 0.0}), half_length_m - 0.035, 1e-5);
}

}  // namespace
}  // namespace spoonbill
