// Tests ticks whose contact searches exceed their budgets.
#include <gtest/gtest.h>

#include "engine/simulation/simulation.h"
#include "engine/simulation/snapshot.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

// Every sample of two bodies in the same place is near the other body.
TEST(ContactOverflow, IsReportedByTheTickAndLeavesBodiesFinite) {
  Scene scene = small_handle();
  scene.bodies.clear();
  for (const double shift_m : {0.0, 0.0005}) {
    scene.bodies.push_back(
        {"pebble", ellipsoid_tube(64, 64, Vector3(0.0, shift_m, 0.0)), silicone(), {400, {}}});
  }
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_NE(simulation.advance(far_away).flags & tick_flag_contact_overflow, 0U) << tick;
  }
  for (int body = 0; body < 2; ++body) {
    for (const Vector3& node : simulation.lattice(body).positions()) ASSERT_TRUE(node.allFinite());
  }
}

}  // namespace
}  // namespace spoonbill
