// Tests when a tick must search for contacts between bodies again.
#include "engine/simulation/searched_shapes.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr int moved_node = 5;

std::vector<BodyState> ball_and_plate() {
  const Material silicone = bundled_material("silicone-00-30");
  const Body ball = stock_body("ball", SphereSize{0.01}, {0.0, 0.0101, 0.0}, silicone, 100);
  Body plate = stock_body("plate", PlateSize{0.06, 0.06, 0.004, 0.006}, {0.0, -0.002, 0.0}, silicone, 100);
  plate.kind = BodyKind::fixed;
  std::vector<BodyState> states;
  for (const Body& body : {ball, plate})
    states.push_back(make_body_state(body, {}, InstructionSet::baseline).value());
  return states;
}

TEST(SearchedShapes, HoldUntilANodeHasMoved) {
  std::vector<BodyState> bodies = ball_and_plate();
  SearchedShapes searched(bodies);
  EXPECT_FALSE(searched.still_hold(bodies));
  SpringLattice& lattice = bodies[0].lattice;
  lattice.set_displacement(moved_node, {0.001, 0.0, 0.0});
  searched.remember(bodies);
  EXPECT_TRUE(searched.still_hold(bodies));
  const double most_m = searched_motion_cells * static_cast<double>(lattice.cell_size_m());
  lattice.set_displacement(moved_node, {0.001 + 0.9 * most_m, 0.0, 0.0});
  EXPECT_TRUE(searched.still_hold(bodies));
  lattice.set_displacement(moved_node, {0.001, 1.1 * most_m, 0.0});
  EXPECT_FALSE(searched.still_hold(bodies));
  searched.remember(bodies);
  lattice.set_displacement(moved_node, {0.0, 0.0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_FALSE(searched.still_hold(bodies));
}

TEST(SearchedShapes, AreForgotten) {
  const std::vector<BodyState> bodies = ball_and_plate();
  SearchedShapes searched(bodies);
  searched.remember(bodies);
  searched.forget();
  EXPECT_FALSE(searched.still_hold(bodies));
}

TEST(SearchedShapes, DoNotHoldWhileARigidBodyMoves) {
  std::vector<BodyState> bodies = ball_and_plate();
  SearchedShapes searched(bodies);
  searched.remember(bodies);
  ASSERT_TRUE(bodies[1].rigid);
  TurnBody turn;
  turn.body = 1;
  turn.angle_deg = 1.0;
  bodies[1].rigid->turn(turn);
  bodies[1].rigid->begin_step(tick_s);
  EXPECT_FALSE(searched.still_hold(bodies));
}

}  // namespace
}  // namespace spoonbill
