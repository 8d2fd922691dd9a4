// Tests what is outside and below a rim, and when food spills.
#include "engine/trial/spill.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/scene/place_body.h"
#include "engine/trial/rim.h"
#include "engine/trial/trial.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr BowlSize bowl_size{0.06, 0.042, 0.01, 0.001};

Body bowl_body() {
  Body bowl = stock_body("bowl", bowl_size, Vector3::Zero(), bundled_material("steel-304"), 300);
  bowl.kind = BodyKind::fixed;
  bowl.rim = bowl_shape(bowl_size)->rim;
  return bowl;
}

TEST(Rim, IsThatOfABowl) {
  const Body bowl = bowl_body();
  const auto rim = Rim::on_surface(bowl.surface, bowl.rim, Vector3::UnitY());
  ASSERT_TRUE(rim);
  EXPECT_GT(rim->normal().y(), 0.9999);
  EXPECT_LT(Rim::on_surface(bowl.surface, bowl.rim, -Vector3::UnitY())->normal().y(), -0.9999);
  EXPECT_NEAR(rim->height_m({0.01, -0.004, 0.01}), -0.004, 1e-5);
  // Points just inside and outside of the elliptic edge.
  const double half_x = position(bowl.surface, 0.0, 1.0).x(), half_z = position(bowl.surface, 0.0, 0.5).z();
  for (int k = 0; k < 64; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 64.0;
    const Vector3 edge(half_x * std::cos(angle), 0.02, half_z * std::sin(angle));
    EXPECT_FALSE(rim->is_outside({0.998 * edge.x(), edge.y(), 0.998 * edge.z()})) << k;
    EXPECT_TRUE(rim->is_outside({1.002 * edge.x(), edge.y(), 1.002 * edge.z()})) << k;
  }
}

// The ring around a ball is a rim as well. Its last corner is at the place of the first.
TEST(Rim, MayBeARing) {
  const Surface ball = stock_surface(SphereSize{0.01});
  const auto rim = Rim::on_surface(ball, {{0.0, 0.7}, {0.5, 0.7}, {1.0, 0.7}}, Vector3::UnitY());
  ASSERT_TRUE(rim);
  const Vector3 edge = position(ball, 0.0, 0.7);
  EXPECT_NEAR(rim->height_m(edge), 0.0, 1e-6);
  EXPECT_FALSE(rim->is_outside(0.99 * edge));
  EXPECT_TRUE(rim->is_outside(1.01 * edge));
}

TEST(Rim, IsNotALineThatEnclosesNothing) {
  const Surface ball = stock_surface(SphereSize{0.01});
  const Vector3 up = Vector3::UnitY();
  EXPECT_FALSE(Rim::on_surface(ball, {{0.2, 0.2}, {0.2, 0.4}, {0.2, 0.6}}, up));
  EXPECT_FALSE(Rim::on_surface(ball, {{0.0, 0.0}, {0.3, 0.0}, {0.6, 0.0}}, up));  // a pole
}

Body block_at(const Vector3& centre_m) {
  Body block = stock_body("block", BoxSize{{0.01, 0.01, 0.01}, 0.001}, centre_m,
                          made_elastic(bundled_material("gelatin-10-1")), 300);
  block.lattice.cells = LatticeCells::box;
  block.lattice.counts = {{5, 5, 5}};
  return block;
}

SpillWatch watch_for(Simulation& simulation, double seconds) {
  SpillWatch watch(simulation.scene());
  for (double time_s = 0.0; time_s < seconds; time_s += tick_s) {
    simulation.advance(trial_input());
    watch.follow(simulation, time_s + tick_s);
  }
  return watch;
}

// A block falls freely along a slope of 45 degrees, over the front of a bowl. It leaves when its centre
// passes the edge, and spills when its lowest nodes pass the plane of the rim.
TEST(SpillWatch, TellsWhenABlockFallsPastTheRim) {
  Scene scene;
  scene.bodies = {block_at({0.0, 0.06, 0.0}), bowl_body()};
  const double along = std::sqrt(0.5);
  scene.sculpting.gravity_m_per_s2 = standard_gravity_m_per_s2 * Vector3(along, -along, 0.0);
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  const SpillWatch watch = watch_for(simulation, 0.16);
  EXPECT_EQ(watch.find(1), nullptr);
  const Spill* const spill = watch.find(0);
  ASSERT_NE(spill, nullptr);
  EXPECT_DOUBLE_EQ(spill->outside_fraction, 1.0);
  EXPECT_GT(spill->spilled_fraction, 0.99);
  ASSERT_TRUE(spill->left_s && spill->first_spill_s);
  const auto time_to_s = [&](double distance_m) {
    return std::sqrt(2.0 * distance_m / (along * standard_gravity_m_per_s2));
  };
  // Measured every 5 ms.
  EXPECT_NEAR(*spill->left_s, time_to_s(position(scene.bodies[1].surface, 0.0, 1.0).x()), 0.006);
  EXPECT_NEAR(*spill->first_spill_s, time_to_s(0.055), 0.007);
}

TEST(SpillWatch, MeasuresWhatIsOutside) {
  Body block = stock_body("block", BoxSize{{0.02, 0.01, 0.01}, 0.001}, {0.025, 0.02, 0.0},
                          made_elastic(bundled_material("gelatin-10-1")), 2000);
  block.lattice.cells = LatticeCells::box;
  Scene scene;
  scene.bodies = {block, bowl_body()};
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  const SpillWatch watch = watch_for(simulation, tick_s);
  ASSERT_NE(watch.find(0), nullptr);
  const Spill& spill = *watch.find(0);
  // The block reaches from x = 15 mm to 35 mm, and the rim to 29.8 mm, 29 mm at the block's sides. A layer of
  // nodes has a twelfth of the mass.
  EXPECT_NEAR(spill.outside_fraction, 5.5 / 20.0, 0.07);
  EXPECT_EQ(spill.spilled_fraction, 0.0);
  EXPECT_FALSE(spill.left_s || spill.first_spill_s);
}

// A bowl that is turned upside down keeps nothing, although what falls out of it is straight below its rim.
TEST(SpillWatch, SeesWhatFallsOutOfABowlUpsideDown) {
  Body block = block_at({0.0, -0.004, 0.0});
  block.kind = BodyKind::rigid;
  Scene scene;
  scene.bodies = {block, bowl_body()};
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  ASSERT_TRUE(simulation.apply(TurnBody{1, Vector3::Zero(), Vector3::UnitX(), 180.0, 360.0}).ok());
  const SpillWatch watch = watch_for(simulation, 1.0);
  ASSERT_NE(watch.find(0), nullptr);
  const Spill& spill = *watch.find(0);
  EXPECT_EQ(spill.outside_fraction, 1.0);
  EXPECT_EQ(spill.spilled_fraction, 1.0);
  EXPECT_TRUE(spill.left_s && spill.first_spill_s);
}

// The bowl bears the other bowl, which is lowered, although that has a rim too. A block beside it was never
// in it.
TEST(SpillWatch, WatchesWhatIsInsideTheRim) {
  Body lowered = bowl_body(), beside = block_at({0.1, 0.02, 0.0});
  lowered.name = "lowered";
  lowered.kind = BodyKind::deformable;
  move_body({Vector3(0.0, 0.03, 0.0), Quaternion::Identity()}, lowered);
  beside.name = "beside";
  Scene scene;
  scene.bodies = {lowered, bowl_body(), beside};
  scene.trial = TrialPlan{"lowered", 0.01, "", Vector3::Zero(), Vector3::UnitX(), 0.0, 30.0};
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  const SpillWatch watch = watch_for(simulation, tick_s);
  EXPECT_NE(watch.find(0), nullptr);
  EXPECT_EQ(watch.find(1), nullptr);
  EXPECT_EQ(watch.find(2), nullptr);
}

TEST(SpillWatch, KnowsNothingWithoutARim) {
  Scene scene;
  scene.bodies = {block_at({0.0, 0.02, 0.0}), bowl_body()};
  scene.bodies[1].rim.clear();
  Simulation simulation = make_simulation(make_trial_scene(scene, {}).value());
  EXPECT_EQ(watch_for(simulation, tick_s).find(0), nullptr);
}

}  // namespace
}  // namespace spoonbill
