// Tests soft bodies that fall out of the scene.
#include <gtest/gtest.h>

#include "engine/simulation/body_hold.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/rigid_samples.h"

namespace spoonbill {
namespace {

// A soft body falls by a metre in 0.45 s.
TEST(GoneBody, StaysWhereItIs) {
  Scene scene;
  scene.bodies = {stock_body("jelly", BoxSize{{0.03, 0.02, 0.03}, 0.002}, Vector3::Zero(),
                             bundled_material("gelatin-20-1"), 300)};
  Simulation simulation = make_trial_of(scene);
  for (int tick = 0; tick < 400; ++tick) simulation.advance(trial_input());
  EXPECT_FALSE(simulation.is_gone(0));
  for (int tick = 0; tick < 100; ++tick) simulation.advance(trial_input());
  EXPECT_TRUE(simulation.is_gone(0));
  const double height_m = find_mass_centre(simulation.lattice(0)).position_m.y();
  EXPECT_NEAR(height_m, -1.05, 0.04);  // half of the jelly's height farther, and up to 16 ticks later
  for (int tick = 0; tick < 100; ++tick) simulation.advance(trial_input());
  EXPECT_EQ(find_mass_centre(simulation.lattice(0)).position_m.y(), height_m);
  EXPECT_EQ(simulation.fastest_m_per_s(0), 0.0);
}

}  // namespace
}  // namespace spoonbill
