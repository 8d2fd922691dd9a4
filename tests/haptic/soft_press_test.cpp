// Two soft bodies on each other: the bundled script presses the bundled fingertip into the bundled cushion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/exchange/document.h"
#include "engine/simulation/body_pair_contact.h"
#include "haptic/script.h"
#include "haptic/tick.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

const std::filesystem::path script_file =
    std::filesystem::path(SPOONBILL_ASSETS) / "recordings" / "soft-press.script.json";

double highest(const Surface& surface) {
  return *std::max_element(surface.net.y.begin(), surface.net.y.end());
}

TEST(SoftPress, BothGiveWayStayApartAndComeBack) {
  const Script script = read_script(script_file).value();
  const Document document = read_document(script.model_file).value();
  Simulation simulation = Simulation::make(document.scene, best_instruction_set()).value();
  VirtualDevice device = VirtualDevice::make(script.hand, script.start).value();
  CouplingState coupling;
  const Surface cushion = simulation.surface(0);
  const double cell =
      static_cast<double>(std::max(simulation.lattice(0).cell_size_m(), simulation.lattice(1).cell_size_m()));
  double deepest = 0.0, strongest = 0.0, lowest_top = highest(cushion);
  for (std::uint64_t t = 0; t < script.tick_count(); ++t) {
    device.set_target(script.target_at(t));
    const TickResult result = tick(simulation, coupling, device.specification(), device.read());
    device.set_force(result.force_n);
    strongest = std::max(strongest, result.force_n.norm());
    lowest_top = std::min(lowest_top, evaluate(simulation.surface(0), 0.75, 0.0).position_m.y());
    if (t % 25 == 0) deepest = std::max(deepest, depth_between(simulation.surface(0), simulation.surface(1)));
  }
  EXPECT_LT(deepest, body_depth_limit_cells * cell);
  EXPECT_GT(strongest, 0.5);
  EXPECT_LE(strongest, device.specification().maximum_force_n);
  EXPECT_LT(lowest_top, 0.0105) << "the cushion has a dent";
  double farthest = 0.0;
  for (std::size_t p = 0; p < cushion.net.y.size(); ++p) {
    farthest = std::max(farthest, std::abs(cushion.net.y[p] - simulation.surface(0).net.y[p]));
  }
  EXPECT_LT(farthest, 0.3e-3) << "elastic";
}

}  // namespace
}  // namespace spoonbill
