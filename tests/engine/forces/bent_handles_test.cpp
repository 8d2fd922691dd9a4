// Tests how far the tip of a stiff handle follows the hand that presses it. The hand's coupling and the
// handle act as two springs in series.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// Stiffness in N/m of the spring between the tool and the hand, for a usual haptic device. It is divided by
// the force scale.
constexpr double device_n_per_m = 700.0;

struct Bend {
  const char* material;
  double force_scale, expected;
};

void PrintTo(const Bend& bend, std::ostream* out) {
  *out << bend.material;
}

class BentHandle : public testing::TestWithParam<Bend> {};

TEST_P(BentHandle, FollowsTheHand) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  const Bend& bend = GetParam();
  Scene scene = bundled_scene("spoon-handle");
  scene.bodies[0].material = bundled_material(bend.material);
  scene.bodies[0].supports = {{BodyRegion{{0.0, 0.02}, {0.0, 1.0}}}};
  scene.planes.clear();
  scene.sculpting.is_critically_damped = true;
  scene.sculpting.force_scale = bend.force_scale;
  Simulation simulation = make_simulation(scene);
  constexpr double tip_m = 0.096, travel_m = 0.004;
  ToolInput input;
  input.coupling_n_per_m = device_n_per_m / bend.force_scale;
  // The tool is first lowered until it touches the handle.
  double height_m = 0.03;
  bool touching = false;
  while (!touching && height_m > 0.0) {
    input.pose.position_m = {tip_m, height_m, 0.0};
    touching = simulation.advance(input).touching;
    if (!touching) height_m -= 2e-5;
  }
  ASSERT_TRUE(touching);
  double proxy_m = 0.0, force_n = 0.0;
  constexpr int ticks = 3000, mean_ticks = 500;
  for (int tick = 1; tick <= ticks; ++tick) {
    input.pose.position_m.y() = height_m - travel_m * std::min(1.0, tick / 1000.0);
    const Reaction reaction = simulation.advance(input);
    if (tick <= ticks - mean_ticks) continue;
    proxy_m += reaction.proxy.position_m.y() / mean_ticks;
    force_n += reaction.force_n.y() / mean_ticks;
  }
  const double followed = (height_m - proxy_m) / travel_m;
  const double handle_n_per_m = force_n / (followed * travel_m);
  const double expected = input.coupling_n_per_m / (input.coupling_n_per_m + handle_n_per_m);
  print_result("bent handle", std::string(bend.material) + ": tip follows", 100.0 * followed,
               "% of the hand");
  EXPECT_NEAR(followed / bend.expected, 1.0, 0.1);
  EXPECT_NEAR(followed / expected, 1.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(, BentHandle,
                         testing::Values(Bend{"abs", 0.1, 0.91}, Bend{"steel-304", 0.002, 0.84}));

}  // namespace
}  // namespace spoonbill
