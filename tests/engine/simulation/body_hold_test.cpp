// Tests which bodies are restored at the end of a tick because they left the scene or broke.
#include "engine/simulation/body_hold.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

constexpr double reach_m = 0.04;

SpringLattice small_block() {
  return block({0.02, 0.02, 0.02}, {4, 5, 6}, elastic_material(5000.0, 0.3, 1000.0));
}

constexpr int some_node = 17;
const Vector3 first_move(1e-3, 2e-3, 0.0);

// Moves a node of a block after the start of a tick, and returns true if the block was restored.
bool is_restored(const Vector3& displacement_m, const Vector3& velocity_m_per_s) {
  SpringLattice lattice = small_block();
  BodyHold hold(lattice);
  lattice.set_displacement(some_node, first_move);
  hold.begin(lattice);
  lattice.set_displacement(some_node, displacement_m);
  lattice.set_velocity(some_node, velocity_m_per_s);
  const bool restored = hold.limit(lattice, nullptr, reach_m);
  EXPECT_LT((lattice.displacement(some_node) - (restored ? first_move : displacement_m)).norm(), 1e-9);
  EXPECT_TRUE(!restored || lattice.velocity(some_node).isZero(0.0));
  return restored;
}

TEST(BodyHold, RestoresABodyWithANodeOutOfReach) {
  EXPECT_FALSE(is_restored({0.02, 0.0, 0.0}, Vector3::Zero()));
  EXPECT_TRUE(is_restored({0.06, 0.0, 0.0}, Vector3::Zero()));
  EXPECT_TRUE(is_restored({0.0, -0.06, 0.0}, Vector3::Zero()));
}

TEST(BodyHold, RestoresABodyThatIsNotFinite) {
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {infinity, -infinity, not_a_number}) {
    EXPECT_TRUE(is_restored(first_move, {0.0, value, 0.0})) << value;
  }
  EXPECT_FALSE(is_restored(first_move, {0.0, 1e30, 0.0}));
  SpringLattice lattice = small_block();
  BodyHold hold(lattice);
  hold.begin(lattice);
  lattice.set_displacement(some_node, {0.0, 0.0, not_a_number});
  EXPECT_TRUE(hold.limit(lattice, nullptr, reach_m));
  EXPECT_TRUE(lattice.displacement(some_node).isZero(0.0));
}

// The distance from the centre of mass counts, not the displacement.
TEST(BodyHold, LetsABodyMoveAsAWhole) {
  SpringLattice lattice = small_block();
  BodyHold hold(lattice);
  hold.begin(lattice);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) lattice.set_displacement(n, {5.0, 0.0, -5.0});
  EXPECT_FALSE(hold.limit(lattice, nullptr, reach_m));
  EXPECT_GT(lattice.displacement(some_node).x(), 4.9);
}

}  // namespace
}  // namespace spoonbill
