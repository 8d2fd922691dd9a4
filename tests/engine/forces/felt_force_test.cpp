// Tests the force on a tool that presses a block. The force at rest is the same for any number of substeps,
// and a quick press ends with the same force as a slow one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include "engine/bspline/evaluate.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double top_m = 0.01, sphere_m = 0.01, press_m = 0.003;

// Returns a scene with a block of 44 x 20 x 40 mm that is fixed at its lower face.
Scene block_scene(const std::string& material, int node_budget) {
  BoxSize size;
  size.size_m = {0.044, 0.02, 0.04};
  size.rounding_m = 0.003;
  Scene scene;
  scene.bodies = {
      stock_body("block", size, Vector3::Zero(), made_elastic(bundled_material(material)), node_budget)};
  scene.planes = {{Vector3(0.0, -0.0085, 0.0), Vector3::UnitY()}};
  scene.tool.radius_m = sphere_m;
  return scene;
}

// Returns the input of a rigid hand that holds the sphere at a depth below the block's upper face.
ToolInput at_depth(double depth_m) {
  ToolInput input;
  input.pose.position_m = {0.0, top_m + sphere_m - depth_m, 0.0};
  return input;
}

struct Held {
  double mean_n = 0.0, ripple = 0.0;
};

// Presses the sphere into the block within `press_s` and holds it there. Returns the mean force and its
// ripple over the last tenth of the ticks.
Held press_and_hold(Simulation& simulation, double press_s, int ticks) {
  Held held;
  double least = 0.0, most = 0.0;
  const int last = ticks / 10;
  for (int tick = 1; tick <= ticks; ++tick) {
    const double depth_m = press_m * std::min(1.0, 1e-3 * tick / press_s);
    const double force_n = simulation.advance(at_depth(depth_m)).force_n.y();
    if (tick <= ticks - last) continue;
    least = tick == ticks - last + 1 ? force_n : std::min(least, force_n);
    most = tick == ticks - last + 1 ? force_n : std::max(most, force_n);
    held.mean_n += force_n / last;
  }
  held.ripple = (most - least) / held.mean_n;
  return held;
}

struct FeltCase {
  const char* material;
  bool settles;
  ForceRun run;
};

void PrintTo(const FeltCase& felt, std::ostream* out) {
  *out << felt.material << (felt.settles ? ", settles" : ", drag of 20/s");
}

class FeltForce : public testing::TestWithParam<FeltCase> {};

TEST_P(FeltForce, IsTheSameForAnyNumberOfSubsteps) {
  const FeltCase& felt = GetParam();
  if (const std::string reason = find_skip_reason(felt.run); !reason.empty()) GTEST_SKIP() << reason;
  const bool is_whole = find_skip_reason(ForceRun::whole_table).empty();
  const bool is_full = find_skip_reason(ForceRun::full).empty();
  const std::vector<int> substeps = is_whole  ? std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8}
                                    : is_full ? std::vector<int>{2, 4, 8}
                                              : std::vector<int>{2, 6};
  std::vector<double> forces;
  for (const int count : substeps) {
    Scene scene = block_scene(felt.material, is_full ? 2000 : 600);
    scene.tool.substeps = count;
    scene.sculpting.drag_per_s = felt.settles ? 0.0 : 20.0;
    scene.sculpting.is_critically_damped = felt.settles;
    Simulation simulation = make_simulation(scene);
    const Held held = press_and_hold(simulation, 0.5, is_full ? 5000 : 2500);
    const std::string what = std::string(felt.material) + (felt.settles ? ", settles, " : ", drag 20/s, ") +
                             std::to_string(count) + " substeps";
    print_result("felt force", what + ": mean", held.mean_n, "N");
    print_result("felt force", what + ": ripple", held.ripple);
    EXPECT_LT(held.ripple, 0.02) << what;
    forces.push_back(held.mean_n);
  }
  const auto [least, most] = std::minmax_element(forces.begin(), forces.end());
  EXPECT_GT(*least, 0.0);
  EXPECT_LT(*most / *least, 1.01);
}

INSTANTIATE_TEST_SUITE_P(, FeltForce,
                         testing::Values(FeltCase{"silicone-00-30", true, ForceRun::always},
                                         FeltCase{"gelatin-20-1", true, ForceRun::whole_table},
                                         FeltCase{"gelatin-20-1", false, ForceRun::whole_table},
                                         FeltCase{"silicone-00-30", false, ForceRun::whole_table}));

// The lattice of the block is so fine that the sphere is equally deep at several places, and the sphere's
// nearest point jumps between them.
TEST(HeldSphere, FeelsASteadyForceWhereSeveralPlacesAreEquallyDeep) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = block_scene("silicone-00-30", 2000);
  scene.tool.substeps = 1;
  scene.sculpting.is_critically_damped = true;
  Simulation simulation = make_simulation(scene);
  EXPECT_LT(press_and_hold(simulation, 0.5, 2500).ripple, 0.005);
}

// Returns how far the block's upper face is below its first height, at most, in the middle of the block.
double dent_m(const Surface& surface) {
  constexpr int samples = 400;
  double lowest_m = top_m;
  for (int i = 0; i < samples; ++i) {
    for (int j = 0; j <= samples; ++j) {
      const Vector3 point =
          position(surface, surface.u.domain_start() + surface.u.domain_length() * i / samples,
                   surface.v.domain_start() + surface.v.domain_length() * j / samples);
      if (point.y() > 0.0 && std::hypot(point.x(), point.z()) < 0.2 * sphere_m) {
        lowest_m = std::min(lowest_m, point.y());
      }
    }
  }
  return top_m - lowest_m;
}

// The surface follows the lattice to within a few hundredths of a millimetre. If the points that the sphere
// pushes were on chords of the dented surface, the dent would be 0.3 mm too deep.
TEST(HeldSphere, DentsTheBlockAsDeepAsItIsPressed) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = block_scene("silicone-00-30", 600);
  scene.tool.substeps = 4;
  scene.sculpting.is_critically_damped = true;
  Simulation simulation = make_simulation(scene);
  press_and_hold(simulation, 0.5, 1500);
  EXPECT_NEAR(dent_m(simulation.surface()), press_m, 1e-4);
}

// The sphere rests on many points of each cell. If contacts were always solved in the same order, such a
// block would shake for ever after a quick press, with a ripple of 46 % of the force.
TEST(HeldSphere, ComesToRestAfterAQuickPress) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = block_scene("silicone-00-30", 600);
  scene.tool.substeps = 4;
  scene.sculpting.drag_per_s = 20.0;
  Simulation simulation = make_simulation(scene);
  EXPECT_LT(press_and_hold(simulation, 0.05, 2000).ripple, 0.005);
}

struct Presses {
  double peak_over_held = 0.0, held_over_slow = 0.0;
};

Presses compare_presses(const std::string& material, bool real_time) {
  Scene scene = block_scene(material, 600);
  scene.sculpting.real_time = real_time;
  scene.sculpting.drag_per_s = 20.0;
  constexpr int ticks = 3000;
  Simulation slow = make_simulation(scene);
  const double held_n = press_and_hold(slow, 1.5, ticks).mean_n;
  Simulation quick = make_simulation(scene);
  double peak_n = 0.0, last_n = 0.0;
  for (int tick = 1; tick <= ticks; ++tick) {
    last_n = quick.advance(at_depth(press_m * std::min(1.0, tick / 50.0))).force_n.y();
    peak_n = std::max(peak_n, last_n);
  }
  return {peak_n / held_n, last_n / held_n};
}

TEST(QuickPress, PeaksNearTheHeldForceInRealTime) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  for (const char* material : {"gelatin-20-1", "silicone-00-30"}) {
    const Presses real = compare_presses(material, true), sculpted = compare_presses(material, false);
    print_result("quick press", std::string(material) + ", real time: peak over held", real.peak_over_held);
    print_result("quick press", std::string(material) + ", sculpting: peak over held",
                 sculpted.peak_over_held);
    EXPECT_NEAR(real.peak_over_held, 1.0, 0.2) << material;
    EXPECT_NEAR(real.held_over_slow, 1.0, 0.02) << material;
    EXPECT_NEAR(sculpted.held_over_slow, 1.0, 0.02) << material;
  }
}

}  // namespace
}  // namespace spoonbill
