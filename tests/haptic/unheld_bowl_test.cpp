// Tests a bowl of clay without fixed nodes under strokes of scripts: the bowl stays in the scene and follows
// the tool.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "haptic/script.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

struct ScriptedStroke {
  double scene_size_m = 0.0;
  double farthest_m = 0.0;  // largest distance of a node from the centre of the scene
  double travel_m = 0.0;    // distance of the hand from where it first touched, at the last contact
  // Largest displacement of nodes near the hand along the hand's travel, at the last contact.
  double followed_m = 0.0;
};

ScriptedStroke play(const std::string& name) {
  const Script script =
      read_script(std::filesystem::path(SPOONBILL_TEST_INPUTS) / (name + ".script.json")).value();
  const Document document = read_document(script.model_file).value();
  Simulation simulation = Simulation::make(document.scene, best_instruction_set()).value();
  VirtualDevice device = VirtualDevice::make(script.hand, script.start).value();
  CouplingState coupling;
  const auto nodes = [&] {
    std::vector<Vector3> all;
    for (std::size_t b = 0; b < document.scene.bodies.size(); ++b) {
      const std::vector<Vector3> of_body = simulation.lattice(static_cast<int>(b)).positions();
      all.insert(all.end(), of_body.begin(), of_body.end());
    }
    return all;
  };
  const std::vector<Vector3> first = nodes();
  Box box;
  for (const Vector3& node : first) box.include(node);
  ScriptedStroke stroke;
  stroke.scene_size_m = box.size();
  std::optional<Vector3> touch_m;
  for (std::uint64_t t = 0; t < script.tick_count(); ++t) {
    device.set_target(script.target_at(t));
    const DeviceReading reading = *device.read();
    const TickResult result = tick(simulation, coupling, device.specification(), reading);
    device.set_force(result.force_n);
    EXPECT_TRUE(result.force_n.allFinite());
    if (result.touching && !touch_m) touch_m = reading.pose().position_m;
    if (t % 20 != 0) continue;
    const std::vector<Vector3> now = nodes();
    for (const Vector3& node : now)
      stroke.farthest_m = std::max(stroke.farthest_m, (node - box.centre()).norm());
    if (!result.touching) continue;
    const Vector3 travel_m = reading.pose().position_m - *touch_m;
    stroke.travel_m = travel_m.norm();
    stroke.followed_m = 0.0;
    for (std::size_t n = 0; n < now.size(); ++n) {
      if ((now[n] - reading.pose().position_m).norm() > 1.5 * document.scene.tool.radius_m) continue;
      stroke.followed_m = std::max(stroke.followed_m, (now[n] - first[n]).dot(travel_m.normalized()));
    }
  }
  return stroke;
}

TEST(UnheldBowl, StaysInTheScene) {
  for (const std::string name : {"unheld-bowl-sideways", "unheld-bowl-down", "handle-and-bowl"}) {
    // Only a full run plays this script, because UnheldBowl.FollowsTheToolByHalfOfItsTravel also moves the
    // tool down.
    if (name == "unheld-bowl-down" && !is_full_run()) continue;
    const ScriptedStroke stroke = play(name);
    EXPECT_LT(stroke.farthest_m, stroke.scene_size_m) << name;
    EXPECT_GT(stroke.travel_m, 0.0) << name << " touches";
  }
}

// The coupling is soft at this force scale, so the hand is ahead of the tool until the clay has followed.
TEST(UnheldBowl, FollowsTheToolByHalfOfItsTravel) {
  const ScriptedStroke stroke = play("unheld-bowl-deep");
  EXPECT_GT(stroke.travel_m, 4e-3);
  EXPECT_GE(stroke.followed_m, 0.5 * stroke.travel_m);
}

}  // namespace
}  // namespace spoonbill
