// Tests presses of a sphere of 10 mm diameter into blocks of different materials by the bundled scripts: clay
// keeps the dent, silicone springs back, gelatin creeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/exchange/document.h"
#include "haptic/script.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

// Returns the height in m of the lowest point of the block's upper side under the sphere.
double bottom_of_dent(const Surface& surface) {
  constexpr int around = 256, along = 220;
  double lowest = 1.0;
  for (int j = 0; j <= along; ++j) {
    const double v = surface.v.domain_start() +
                     (surface.v.domain_end() - surface.v.domain_start()) * static_cast<double>(j) / along;
    for (int i = 0; i < around; ++i) {
      const Vector3 point = evaluate(surface, static_cast<double>(i) / around, v).position_m;
      if (point.y() > 0.0 && std::hypot(point.x(), point.z()) < 1e-3) lowest = std::min(lowest, point.y());
    }
  }
  return lowest;
}

class ScriptedPress {
 public:
  explicit ScriptedPress(const std::string& name)
      : script_(read_script(std::filesystem::path(SPOONBILL_ASSETS) / "recordings" / (name + ".script.json"))
                    .value()),
        document_(read_document(script_.model_file).value()),
        simulation_(Simulation::make(document_.scene, best_instruction_set()).value()),
        device_(VirtualDevice::make(script_.hand, script_.start).value()),
        first_top_m_(bottom_of_dent(simulation_.surface())),
        first_volume_m3_(simulation_.lattice().volume_m3()) {}

  double end_s() const { return static_cast<double>(script_.tick_count()) * tick_s; }

  void run_to(double time_s) {
    for (; static_cast<double>(ticks_) * tick_s < time_s - 0.5 * tick_s; ++ticks_) {
      device_.set_target(script_.target_at(ticks_));
      const TickResult result = tick(simulation_, coupling_, device_.specification(), *device_.read());
      device_.set_force(result.force_n);
      force_n_ = result.force_n.norm();
      deepest_m_ = std::max(deepest_m_, ticks_ % 50 == 0 ? dent_m() : 0.0);
      EXPECT_LE(force_n_, device_.specification().maximum_force_n);
    }
  }

  double mean_force_n(double from_s, double to_s) {
    run_to(from_s);
    const int count = static_cast<int>(std::lround((to_s - from_s) / tick_s));
    double sum = 0.0;
    for (int t = 1; t <= count; ++t) {
      run_to(from_s + t * tick_s);
      sum += force_n();
    }
    return sum / count;
  }

  double dent_m() const { return first_top_m_ - bottom_of_dent(simulation_.surface()); }
  double deepest_m() const { return deepest_m_; }
  // Returns the force in N on the material.
  double force_n() const { return force_n_ / document_.scene.sculpting.force_scale; }
  double volume_change() const { return simulation_.lattice().volume_m3() / first_volume_m3_ - 1.0; }
  const Material& material() const { return document_.scene.bodies[0].material; }
  double radius_m() const { return document_.scene.tool.radius_m; }

 private:
  Script script_;
  Document document_;
  Simulation simulation_;
  VirtualDevice device_;
  CouplingState coupling_;
  double first_top_m_, first_volume_m3_;
  double deepest_m_ = 0.0, force_n_ = 0.0;
  std::uint64_t ticks_ = 0;
};

TEST(MaterialPress, ClayKeepsItsDentAndItsVolume) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  ScriptedPress press("clay-press");
  EXPECT_DOUBLE_EQ(press.radius_m(), 0.005);
  press.run_to(press.end_s());
  EXPECT_GT(press.deepest_m(), 0.0048);
  EXPECT_LT(press.deepest_m(), 0.0052);
  EXPECT_GT(press.dent_m(), 0.9 * press.deepest_m());
  EXPECT_LT(std::abs(press.volume_change()), 1e-3);
}

TEST(MaterialPress, SiliconeSpringsBack) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  ScriptedPress press("silicone-press");
  press.run_to(2.0);
  const double held_m = press.dent_m(), felt_n = press.force_n();
  EXPECT_GT(held_m, 0.0045);
  // Hertz's formula is for a sphere on a half-space and a small contact. Here the dent is as deep as the
  // radius, the block is only four dents thick, and its cells are 2 mm wide; together these change the force
  // by less than a quarter.
  const Material& silicone = press.material();
  const double plane_modulus_pa =
      silicone.youngs_modulus_pa / (1.0 - silicone.poissons_ratio * silicone.poissons_ratio);
  const double hertz_n = 4.0 / 3.0 * plane_modulus_pa * std::sqrt(press.radius_m()) * std::pow(held_m, 1.5);
  EXPECT_NEAR(felt_n, hertz_n, 0.25 * hertz_n);
  press.run_to(press.end_s());
  EXPECT_LT(std::abs(press.dent_m()), 0.01 * press.deepest_m());
  EXPECT_LT(std::abs(press.volume_change()), 1e-3);
}

// A standard linear solid at a constant depth loses the relaxing fraction of its force with its relaxation
// time. After release it springs back with a longer time: the relaxation time divided by the fraction that
// does not relax.
TEST(MaterialPress, GelatinCreepsAsItsRelaxationTimeSays) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  ScriptedPress press("gelatin-press");
  const double relaxation_time_s = press.material().relaxation_time_s;
  const double retardation_time_s = relaxation_time_s / (1.0 - press.material().relaxing_fraction);
  // The means over half a second are 4.5 s apart, so that the relaxing part of the force falls by the same
  // factor from each mean to the next.
  const double first_n = press.mean_force_n(2.0, 2.5), second_n = press.mean_force_n(6.5, 7.0),
               third_n = press.mean_force_n(11.0, 11.5);
  EXPECT_GT(press.dent_m(), 0.0045);
  EXPECT_NEAR(4.5 / std::log((first_n - second_n) / (second_n - third_n)), relaxation_time_s,
              0.2 * relaxation_time_s);
  press.run_to(13.0);
  const double left_m = press.dent_m();
  EXPECT_GT(left_m, 0.1 * press.deepest_m()) << "some of the dent stays for a while";
  press.run_to(press.end_s());
  EXPECT_NEAR(press.dent_m() / left_m, std::exp(-(press.end_s() - 13.0) / retardation_time_s), 0.02);
}

}  // namespace
}  // namespace spoonbill
