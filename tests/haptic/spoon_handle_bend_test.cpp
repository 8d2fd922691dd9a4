// Tests that the bundled script bends the bundled handle as in Pungotra et al. (2013): the settled shape is
// bent near the fixed part and nearly straight elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "engine/exchange/document.h"
#include "haptic/script.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::filesystem::path script_file =
    std::filesystem::path(SPOONBILL_ASSETS) / "recordings" / "spoon-handle-bend.script.json";

Vector3 ring_centre(const Surface& surface, double v) {
  constexpr int around = 96;
  Vector3 sum = Vector3::Zero();
  for (int s = 0; s < around; ++s)
    sum += evaluate(surface, static_cast<double>(s) / around, v).position_m / around;
  return sum;
}

// Returns the angle in degrees by which the centre line between two values of v points below the horizontal.
double turned(const Surface& surface, double from_v, double to_v) {
  const Vector3 way = ring_centre(surface, to_v) - ring_centre(surface, from_v);
  return std::atan2(-way.y(), way.x()) * 180.0 / std::numbers::pi;
}

struct Bend {
  Surface before, pushed, settled;
  SpringLattice lattice;
  double plane_v, sphere_v;
};

Bend play() {
  const Script script = read_script(script_file).value();
  const Document document = read_document(script.model_file).value();
  Simulation simulation = Simulation::make(document.scene, best_instruction_set()).value();
  VirtualDevice device = VirtualDevice::make(script.hand, script.start).value();
  CouplingState coupling;
  std::size_t next = 0;
  std::optional<Surface> before, pushed;
  for (std::uint64_t t = 0; t < script.tick_count(); ++t) {
    for (; next < script.commands.size() && script.commands[next].tick <= t; ++next) {
      const Command command = command_from_json(script.commands[next].command, "script").value();
      EXPECT_TRUE(simulation.apply(command).ok());
      before = simulation.surface();
    }
    device.set_target(script.target_at(t));
    const TickResult result = tick(simulation, coupling, device.specification(), *device.read());
    device.set_force(result.force_n);
    if (script.target_at(t).pose.position_m.y() < -0.0205) pushed = simulation.surface();
  }
  EXPECT_TRUE(before && pushed);
  // The fixing plane is at v = 40 of the straight handle, and the sphere is above v = 88. The parameter v is
  // the distance along the handle in millimetres.
  return {*before, *pushed, simulation.surface(), simulation.lattice(), 40.0, 88.0};
}

TEST(SpoonHandleBend, TheSettledShapeIsThePapers) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const Bend bend = play();
  const double pushed = turned(bend.pushed, bend.sphere_v - 2.0, bend.sphere_v + 2.0);
  const double kept = turned(bend.settled, bend.sphere_v - 2.0, bend.sphere_v + 2.0);
  EXPECT_GT(pushed, 25.0);
  EXPECT_GE(kept / pushed, 0.75);
  const double quarter = bend.plane_v + 0.25 * (bend.sphere_v - bend.plane_v);
  EXPECT_GE(turned(bend.settled, quarter - 1.0, quarter + 1.0) / kept, 0.80);
  // The handle is straight beyond the sphere: the parts from v = 90 to 93 and from v = 94 to 97 point in the
  // same direction.
  EXPECT_NEAR(turned(bend.settled, 90.0, 93.0), turned(bend.settled, 94.0, 97.0), 0.5);

  double fixed_surface = 0.0;
  for (int a = 0; a < 64; ++a) {
    for (int b = 0; b <= 160; ++b) {
      const double u = a / 64.0, v = 40.0 * b / 160.0;
      fixed_surface =
          std::max(fixed_surface,
                   (evaluate(bend.settled, u, v).position_m - evaluate(bend.before, u, v).position_m).norm());
    }
  }
  EXPECT_LE(fixed_surface, 0.01e-3);
  int fixed_nodes = 0;
  for (int n = 0; n < bend.lattice.mesh().node_count(); ++n) {
    if (bend.lattice.mesh().nodes[n].x() > 0.040) continue;
    ++fixed_nodes;
    EXPECT_LE(bend.lattice.displacement(n).norm(), 1e-9);
  }
  EXPECT_GT(fixed_nodes, 500);
  EXPECT_NEAR(bend.lattice.volume_m3() / bend.lattice.rest_volume_m3(), 1.0, 0.002);
}

}  // namespace
}  // namespace spoonbill
