// Tests bodies without fixed nodes that a tool presses. They deform under the tool. As a whole they keep
// their position, unless the setting `free` lets them move.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "engine/simulation/simulation.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

struct PressedBody {
  double away_m = 0.0;     // largest distance of the mean position from its initial value
  double follows_m = 0.0;  // largest movement of a node
  bool is_finite = true;
};

Vector3 mean_position(const std::vector<Vector3>& nodes) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& node : nodes) mean += node / static_cast<double>(nodes.size());
  return mean;
}

// Lowers the tool into the centre of the handle, moves it sideways while it is down, and raises it.
PressedBody press(Scene scene) {
  PressedBody pressed;
  auto simulation = Simulation::make(std::move(scene), best_instruction_set());
  EXPECT_TRUE(simulation.ok());
  const std::vector<Vector3> rest = simulation->lattice().positions();
  const Vector3 start = mean_position(rest);
  const Vector3 way[] = {start + Vector3(0.0, 0.03, 0.0), start + Vector3(0.0, 0.004, 0.0),
                         start + Vector3(0.0, 0.004, -0.006), start + Vector3(0.0, 0.04, 0.0)};
  for (int leg = 0; leg < 3; ++leg) {
    for (int t = 1; t <= 200; ++t) {
      ToolInput input;
      input.pose.position_m = way[leg] + t / 200.0 * (way[leg + 1] - way[leg]);
      simulation->advance(input);
      const std::vector<Vector3> nodes = simulation->lattice().positions();
      const Vector3 mean = mean_position(nodes);
      pressed.is_finite = pressed.is_finite && mean.allFinite();
      pressed.away_m = std::max(pressed.away_m, (mean - start).norm());
      for (std::size_t n = 0; n < nodes.size(); ++n)
        pressed.follows_m = std::max(pressed.follows_m, (nodes[n] - rest[n]).norm());
    }
  }
  return pressed;
}

Scene unheld_scene() {
  Scene scene = small_handle();
  scene.planes.clear();
  scene.sculpting.free = false;
  scene.tool.radius_m = 0.008;
  return scene;
}

TEST(UnheldBodies, KeepTheirPlaceAndFollowTheTool) {
  const PressedBody pressed = press(unheld_scene());
  EXPECT_TRUE(pressed.is_finite);
  EXPECT_LT(pressed.away_m, 1e-3);
  EXPECT_GT(pressed.follows_m, 1e-3);
}

TEST(UnheldBodies, MoveWhereTheyAreFree) {
  Scene scene = unheld_scene();
  scene.sculpting.free = true;
  const PressedBody pressed = press(scene);
  EXPECT_TRUE(pressed.is_finite);
  EXPECT_GT(pressed.away_m, 2e-3);
  EXPECT_LT(pressed.away_m, 1.0);
}

}  // namespace
}  // namespace spoonbill
