#include "engine/collision/solids/swept_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/collision/solids/implicit/implicit_shapes.h"
#include "tests/engine/allocations.h"
#include "tests/engine/collision/solids/implicit/support_function.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const Quaternion none = Quaternion::Identity();

// 5 m/s for 1 ms is 5 mm, far more than the tool is wide.
TEST(SweptContact, AFastToolIsCaughtByAThinSheet) {
  const Surface sheet = quadric_sheet(0.1, 0.0, 0.0, 8);
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceCollider collider(nested);
  const ToolMotion motion{{{0.01, 0.003, 0.02}, none}, {{0.01, -0.002, 0.02}, none}};
  for (const ImplicitShape& shape :
       {ImplicitShape(SphereShape{2e-4}), ImplicitShape(CapsuleShape{1e-4, 1e-4}),
        ImplicitShape(BoxShape{Vector3::Constant(2e-4)}), ImplicitShape(TorusShape{1e-3, 2e-4})}) {
    const auto solid = make_signed_distance(shape);
    ASSERT_FALSE(collider.collide(sheet, ToolShape::solid(*solid, motion.from), 0.0, false).found);
    ASSERT_FALSE(collider.collide(sheet, ToolShape::solid(*solid, motion.to), 0.0, false).found);
    const SweptContact swept = sweep(collider, sheet, *solid, motion);
    ASSERT_TRUE(swept.touches);
    EXPECT_FALSE(swept.undecided);
    // Touches when the height above the sheet is 2e-4; not a micrometre deeper.
    EXPECT_NEAR(0.003 - 0.005 * swept.fraction, 2e-4, 1.1e-6);
    EXPECT_GE(0.003 - 0.005 * swept.fraction, 2e-4 - 1e-9);
    EXPECT_NEAR(swept.contact.normal.y(), 1.0, 1e-9);
  }
  EXPECT_NEAR(0.003 - 0.005 * sweep_sphere(collider, sheet, 2e-4, motion).fraction, 2e-4, 1.1e-6);
}

// A rod lying above the sheet that turns about its middle: its end touches where its height is the radius.
TEST(SweptContact, ATurningRodTouchesWithItsEnd) {
  const Surface sheet = quadric_sheet(0.1, 0.0, 0.0, 8);
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceCollider collider(nested);
  const auto rod = make_signed_distance(CapsuleShape{0.002, 0.04});
  const Quaternion flat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitZ()));
  const Quaternion steep(Eigen::AngleAxisd(0.1, Vector3::UnitZ()));
  const double turn = 0.5 * std::numbers::pi - 0.1;
  const SweptContact swept =
      sweep(collider, sheet, *rod, {{{0.0, 0.02, 0.0}, flat}, {{0.0, 0.02, 0.0}, steep}});
  ASSERT_TRUE(swept.touches);
  EXPECT_NEAR(swept.fraction * turn, std::asin(0.018 / 0.04), 1e-4);
}

TEST(SweptContact, AFreeWayIsFree) {
  const Surface sheet = quadric_sheet(0.1, 0.0, 0.0, 8);
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceCollider collider(nested);
  const SweptContact swept =
      sweep_sphere(collider, sheet, 0.001, {{{-0.08, 0.002, 0.0}, none}, {{0.08, 0.002, 0.0}, none}});
  EXPECT_FALSE(swept.touches);
  EXPECT_FALSE(swept.undecided);
  EXPECT_EQ(swept.fraction, 1.0);
  // A hair over the sheet for long: it says so and never claims more than it has seen.
  const SweptContact near =
      sweep_sphere(collider, sheet, 0.001, {{{-0.08, 0.00101, 0.0}, none}, {{0.08, 0.00101, 0.0}, none}});
  EXPECT_FALSE(near.touches);
  EXPECT_TRUE(near.undecided);
  EXPECT_GT(near.fraction, 0.0);
  EXPECT_LT(near.fraction, 1.0);
  EXPECT_TRUE(
      sweep_sphere(collider, sheet, 0.001, {{{0.0, 0.0005, 0.0}, none}, {{0.0, 1.0, 0.0}, none}}).touches);
}

// Whatever the way, no pose before the fraction is in contact deeper than the tolerance.
TEST(SweptContact, NothingIsPassedOnRandomWays) {
  Random random(71);
  constexpr int trials = effort(60);
  int caught = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Surface surface = random_surface(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 1).value();
    SurfaceCollider collider(nested);
    const auto solid = make_signed_distance(random_convex_shape(random, trial % 6));
    // From above to below, or nearly.
    const auto pose = [&](double height) {
      const Vector3 axis = random_direction(random), at = 0.5 * random_in_cube(random);
      const Quaternion turn(Eigen::AngleAxisd(random.uniform(0.0, 1.5), axis));
      return Pose{{at.x(), 0.5 * at.y() + height, at.z()}, turn};
    };
    const Pose from = pose(0.4);
    const ToolMotion motion{from, pose(-0.1)};
    const SweptContact swept = sweep(collider, surface, *solid, motion);
    if (swept.fraction == 0.0) continue;  // touches where it starts
    caught += swept.touches ? 1 : 0;
    for (int k = 0; k <= 100; ++k) {
      const double fraction = swept.fraction * k / 100;
      const Pose there{motion.from.position_m + fraction * (motion.to.position_m - motion.from.position_m),
                       motion.from.orientation.slerp(fraction, motion.to.orientation)};
      const CollisionResult result = collider.collide(surface, ToolShape::solid(*solid, there), 0.0, false);
      EXPECT_LE(result.nearest.depth_m, touch_tolerance_m) << trial << " at " << fraction;
    }
  }
  EXPECT_GT(caught, trials / 6);
  EXPECT_LT(caught, trials);
}

TEST(SweptContact, AllocatesNothing) {
  const Surface sheet = quadric_sheet(0.1, 3.0, -2.0, 8);
  const NestedGrid nested = make_nested_grid(sheet.u, sheet.v, 2).value();
  SurfaceCollider collider(nested);
  const auto solid = make_signed_distance(ConeShape{0.01, 0.02});
  const std::size_t before = allocation_count();
  (void)sweep(collider, sheet, *solid, {{{0.0, 0.1, 0.0}, none}, {{0.01, -0.1, 0.0}, none}});
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
