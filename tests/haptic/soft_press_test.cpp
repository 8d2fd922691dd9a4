// Tests contact of two soft bodies: the bundled script presses the bundled fingertip into the bundled
// cushion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/exchange/document.h"
#include "engine/simulation/body_contact.h"
#include "haptic/script.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

const std::filesystem::path scripts = std::filesystem::path(SPOONBILL_ASSETS) / "recordings";

double highest(const Surface& surface) {
  return *std::max_element(surface.net.y.begin(), surface.net.y.end());
}

double top_in_the_middle(const Surface& surface) {
  double top = -1.0;
  for (int i = 0; i < 32; ++i) top = std::max(top, evaluate(surface, i / 32.0, 0.0).position_m.y());
  return top;
}

// A bundled script that is played tick by tick.
struct Played {
  explicit Played(const char* name)
      : script(read_script(scripts / name).value()),
        simulation(
            Simulation::make(read_document(script.model_file).value().scene, best_instruction_set()).value()),
        device(VirtualDevice::make(script.hand, script.start).value()) {}

  // Calls visit(tick, reading of the device, result) after each tick.
  template <class Visit>
  void play(const Visit& visit) {
    CouplingState coupling;
    for (std::uint64_t t = 0; t < script.tick_count(); ++t) {
      device.set_target(script.target_at(t));
      const DeviceReading reading = *device.read();
      const TickResult result = tick(simulation, coupling, device.specification(), reading);
      device.set_force(result.force_n);
      visit(t, reading, result);
    }
  }

  Script script;
  Simulation simulation;
  VirtualDevice device;
};

TEST(SoftPress, BothGiveWayStayApartAndComeBack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Played played("soft-press.script.json");
  const Simulation& simulation = played.simulation;
  const Surface cushion = simulation.surface(0);
  const double cell =
      static_cast<double>(std::max(simulation.lattice(0).cell_size_m(), simulation.lattice(1).cell_size_m()));
  double deepest = 0.0, strongest = 0.0, lowest_top = highest(cushion);
  played.play([&](std::uint64_t t, const DeviceReading&, const TickResult& result) {
    strongest = std::max(strongest, result.force_n.norm());
    lowest_top = std::min(lowest_top, evaluate(simulation.surface(0), 0.75, 0.0).position_m.y());
    if (t % 25 == 0) deepest = std::max(deepest, depth_between(simulation.surface(0), simulation.surface(1)));
  });
  EXPECT_LT(deepest, body_depth_limit_cells * cell);
  EXPECT_GT(strongest, 0.5);
  EXPECT_LE(strongest, played.device.specification().maximum_force_n);
  EXPECT_LT(lowest_top, 0.0105) << "the cushion has a dent";
  double farthest = 0.0;
  for (std::size_t p = 0; p < cushion.net.y.size(); ++p) {
    farthest = std::max(farthest, std::abs(cushion.net.y[p] - simulation.surface(0).net.y[p]));
  }
  EXPECT_LT(farthest, 0.3e-3) << "elastic";
}

// The hand is not quite still, because the force moves it. The inertia of the tool must not turn its motion
// into a force, and must not hold the hand back when it lets go.
TEST(SoftPress, FeelsSteadyAndIsLetGoAtOnce) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Played played("soft-press.script.json");
  // The script holds the tool from 1.8 s to 2.2 s, and lifts it from 2.2 s to 2.8 s.
  double least = 1e30, most = 0.0, in_the_air = 0.0;
  played.play([&](std::uint64_t t, const DeviceReading&, const TickResult& result) {
    const double force = result.force_n.norm();
    if (t >= 1950 && t < 2200) least = std::min(least, force), most = std::max(most, force);
    if (t >= 2600) in_the_air = std::max(in_the_air, force);
  });
  EXPECT_GT(least, 0.5);
  EXPECT_LT(most - least, 0.02 * most);
  EXPECT_LT(in_the_air, 1e-3);
}

// The bundled soft egg is a mesh. It is dented and recovers its shape.
TEST(SoftPress, AMeshGivesWayTooAndComesBack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Played played("soft-egg.script.json");
  const Simulation& simulation = played.simulation;
  Snapshot snapshot;
  // Returns how far the lowest point of the egg is below the hand.
  const auto hangs_m = [&](double hand_m) {
    simulation.write_snapshot(snapshot);
    const std::vector<float>& y = snapshot.bodies.back().mesh.y;
    return hand_m - static_cast<double>(*std::min_element(y.begin(), y.end()));
  };
  const double first_top = top_in_the_middle(simulation.surface(0));
  double strongest = 0.0, shortest = 1.0, last = 0.0, lowest_top = first_top;
  played.play([&](std::uint64_t t, const DeviceReading& reading, const TickResult& result) {
    strongest = std::max(strongest, result.force_n.norm());
    lowest_top = std::min(lowest_top, top_in_the_middle(simulation.surface(0)));
    EXPECT_EQ(result.flags & tick_flag_contact_overflow, 0u);
    if (t % 25 != 0) return;
    last = hangs_m(reading.pose().position_m.y());
    shortest = std::min(shortest, last);
  });
  EXPECT_GT(strongest, 0.05);
  EXPECT_NEAR(lowest_top, first_top, 0.1e-3) << "the cushion of silicone hardly yields";
  EXPECT_LT(shortest, last - 0.5e-3) << "the egg of gelatin does";
  EXPECT_NEAR(last, 0.025, 0.2e-3) << "which is as it was made";
}

}  // namespace
}  // namespace spoonbill
