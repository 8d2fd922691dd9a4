// Tests that a vibrating force is cut and that taps, ridges, tremors and noise are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "engine/simulation/simulation.h"
#include "haptic/safe_device.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"
#include "tests/engine/random.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

const DeviceSpecification vibrating_device = VirtualDevice::default_specification();

// A force as a function of the tick, counted from 0.
using ForceSource = std::function<Vector3(int tick)>;
using HandPath = std::function<Vector3(int tick)>;

constexpr int never_cut = -1;

// Returns the number of ticks until the force was cut as a vibration, or never_cut. The force has been
// `offset_n` for a second before tick 0, and the position is constant by default.
int find_cut(
    const ForceSource& force_n, int ticks, const Vector3& offset_n = Vector3::Zero(),
    const HandPath& position_m = [](int) { return Vector3(0, 0, 0); }) {
  SafetyState state;
  for (int t = -2000; t < ticks; ++t) {
    SafetyInput input;
    input.position_m = position_m(std::max(0, t));
    if (t >= -1000) input.requested_n = t < 0 ? offset_n : force_n(t);
    if (make_safe(state, vibrating_device, input).flags & safety_flag_buzzing) return t + 1;
  }
  return never_cut;
}

enum class Waveform { circle, sine, square };

// Returns a vibration with a random plane and phase.
ForceSource random_vibration(Random& random, Waveform waveform, double frequency_hz, double amplitude_n,
                             const Vector3& offset_n) {
  const Vector3 along = random.direction(), across = along.cross(random.direction()).normalized();
  // At 500 Hz there are two samples per period, so a random phase could sample only the zeros of the sine.
  const double phase = frequency_hz > 400.0 ? 0.25 : random.uniform(0.0, 1.0);
  return [=](int tick) -> Vector3 {
    const double angle = 2.0 * std::numbers::pi * (frequency_hz * tick * tick_s + phase);
    Vector3 force_n = std::sin(angle) * along;
    if (waveform == Waveform::circle) force_n += std::cos(angle) * across;
    if (waveform == Waveform::square) force_n = std::copysign(1.0, std::sin(angle)) * along;
    return offset_n + amplitude_n * force_n;
  };
}

constexpr Waveform waveforms[] = {Waveform::circle, Waveform::sine, Waveform::square};

TEST(Vibration, OfFullForceIsCutWithin150Milliseconds) {
  Random random(33);
  for (const double frequency_hz : {22.0, 30.0, 47.0, 100.0, 230.0, 300.0, 500.0}) {
    for (const Waveform waveform : waveforms) {
      for (int run = 0; run < random_cases(6, 60); ++run) {
        const Vector3 offset_n = (random.once_in(2) ? 0.0 : random.uniform(0.0, 3.0)) * random.direction();
        const ForceSource force_n = random_vibration(random, waveform, frequency_hz, 3.3, offset_n);
        // In half of the runs the hand moves at a constant velocity.
        const Vector3 speed_m_per_s = (random.once_in(2) ? 0.0 : 0.2) * random.direction();
        const int cut =
            find_cut(force_n, 150, offset_n, [&](int t) { return Vector3(t * tick_s * speed_m_per_s); });
        ASSERT_NE(cut, never_cut) << frequency_hz << " Hz, waveform " << static_cast<int>(waveform);
        // A vibration is cut only after more than two of its periods.
        ASSERT_GT(cut, 2000.0 / frequency_hz);
      }
    }
  }
}

TEST(Vibration, IsCutFrom16HertzOnAndNeverBelow15) {
  Random random(34);
  for (int run = 0; run < random_cases(20, 500); ++run) {
    const Waveform waveform = waveforms[run % 3];
    const double amplitude_n = random.uniform(0.5, 3.3);
    const double fast_hz = random.uniform(16.0, 22.0), slow_hz = random.uniform(0.5, 14.8);
    EXPECT_NE(find_cut(random_vibration(random, waveform, fast_hz, amplitude_n, Vector3::Zero()), 250),
              never_cut)
        << fast_hz;
    EXPECT_EQ(find_cut(random_vibration(random, waveform, slow_hz, amplitude_n, Vector3::Zero()), 1000),
              never_cut)
        << slow_hz;
  }
}

TEST(Vibration, TicksThatWereDroppedCount) {
  SafetyState state;
  Random random(35);
  const ForceSource force_n = random_vibration(random, Waveform::circle, 30.0, 3.3, Vector3::Zero());
  for (int t = 0; t < 1000; ++t) make_safe(state, vibrating_device, {});
  int t = 0;
  SafetyInput input;
  do {
    ASSERT_LT(t, 150);
    input.dropped_ticks = random.bits() % 3;
    t += 1 + static_cast<int>(input.dropped_ticks);
    input.requested_n = force_n(t);
  } while ((make_safe(state, vibrating_device, input).flags & safety_flag_buzzing) == 0);
}

TEST(Vibration, APulseIsNone) {
  Random random(36);
  for (int run = 0; run < random_cases(60, 1000); ++run) {
    const Vector3 peak_n = random.log_uniform(0.5, 300.0) * random.direction();
    const double width = random.uniform(1.0, 50.0);
    const double radians_per_tick = random.uniform(0.0, 2.0);
    const int shape = run % 3;
    const ForceSource pulse = [&](int t) -> Vector3 {
      const double x = (t - 200) / width;
      if (shape == 0) return std::abs(x) < 1.0 ? peak_n : Vector3::Zero();
      if (shape == 1) return std::exp(-x * x) * peak_n;
      return x < 0.0 ? Vector3::Zero()
                     : Vector3(std::exp(-x) * std::cos(radians_per_tick * width * x) * peak_n);
    };
    EXPECT_EQ(find_cut(pulse, 600), never_cut) << "shape " << shape << ", width " << width;
  }
}

TEST(Vibration, WeakNoiseIsNone) {
  Random random(37);
  for (int run = 0; run < random_cases(4, 200); ++run) {
    const double amplitude_n = random.uniform(0.02, 0.3);
    const Vector3 offset_n = random.uniform(0.0, 3.0) * random.direction();
    const ForceSource noise = [&](int) { return Vector3(offset_n + amplitude_n * random.direction()); };
    EXPECT_EQ(find_cut(noise, 2000, offset_n), never_cut) << amplitude_n;
  }
}

struct TouchingRun {
  bool cut = false;
  double strongest_n = 0.0;  // largest requested force
};

// Runs a hand that touches something for some ticks. `touch` returns the requested force for a reading.
TouchingRun run_hand(const Hand& hand, const HandPath& target_m, int ticks,
                     const std::function<Vector3(const DeviceReading&)>& touch) {
  HandTarget target;
  target.pose.position_m = target_m(0);
  VirtualDevice device = VirtualDevice::make(hand, target).value();
  SafeDevice safe(device);
  TouchingRun run;
  for (int t = -300; t < ticks; ++t) {
    target.pose.position_m = target_m(std::max(0, t));
    device.set_target(target);
    const DeviceReading reading = safe.read(0);
    const Vector3 requested_n = touch(reading);
    safe.give(requested_n);
    run.strongest_n = std::max(run.strongest_n, requested_n.norm());
    run.cut = run.cut || (safe.flags() & safety_flag_buzzing) != 0;
  }
  return run;
}

// A rigid surface that the hand feels through the coupling. Its height depends on x.
class RigidSurface {
 public:
  explicit RigidSurface(std::function<double(double x_m)> height_m) : height_m_(std::move(height_m)) {}

  Vector3 touch(const DeviceReading& reading) {
    constexpr double step_m = 1e-5;
    const Vector3 position_m = reading.pose().position_m;
    const double x_m = position_m.x(), height_m = height_m_(x_m);
    const double slope = (height_m_(x_m + step_m) - height_m_(x_m - step_m)) / (2.0 * step_m);
    const Vector3 normal = Vector3(-slope, 1.0, 0.0).normalized();
    const double depth_m = std::max(0.0, height_m - position_m.y()) * normal.y();
    return couple(coupling_, vibrating_device, position_m, depth_m * normal).force_n;
  }

 private:
  std::function<double(double)> height_m_;
  CouplingState coupling_;
};

// Returns a random hand that is stable and damped, or the default hand.
Hand random_damped_hand(Random& random) {
  Hand hand;
  if (random.once_in(2)) return hand;
  hand.mass_kg = random.log_uniform(0.03, 1.0);
  hand.stiffness_n_per_m = random.log_uniform(50.0, std::min(5000.0, hand.mass_kg / (tick_s * tick_s)));
  hand.damping_n_s_per_m = random.uniform(0.3, 1.0) * 2.0 * std::sqrt(hand.mass_kg * hand.stiffness_n_per_m);
  return hand;
}

// Returns the path of a hand that comes down at `speed_m_per_s`, is held at a depth and may leave again.
HandPath tap_path(double top_m, double depth_m, double speed_m_per_s, double held_s, double x_m = 0.0) {
  return [=](int tick) {
    const double down_m = top_m - speed_m_per_s * tick * tick_s;
    const double up_m =
        -depth_m + speed_m_per_s * (tick * tick_s - (top_m + depth_m) / speed_m_per_s - held_s);
    return Vector3(x_m, std::clamp(std::max(down_m, up_m), -depth_m, top_m), 0.0);
  };
}

TEST(Vibration, ATapOnARigidWallIsNone) {
  Random random(38);
  int strong = 0;
  const int runs = random_cases(60, 1000);
  for (int run = 0; run < runs; ++run) {
    const Hand hand = random_damped_hand(random);
    const double depth_m = random.uniform(0.0, 0.02), held_s = random.uniform(0.0, 0.6);
    RigidSurface wall([](double) { return 0.0; });
    const TouchingRun tap = run_hand(hand, tap_path(0.04, depth_m, 0.2, held_s), 1000,
                                     [&](const DeviceReading& reading) { return wall.touch(reading); });
    EXPECT_FALSE(tap.cut) << hand.mass_kg << " kg, " << hand.stiffness_n_per_m << " N/m, "
                          << hand.damping_n_s_per_m << " N s/m, " << depth_m << " m for " << held_s << " s";
    strong += tap.strongest_n > 1.0;
  }
  EXPECT_GT(strong, runs / 2);
}

Scene steel_handle() {
  Scene scene = small_handle();
  Material& material = scene.bodies[0].material;
  material.youngs_modulus_pa = 2e11;
  material.poissons_ratio = 0.3;
  material.density_kg_per_m3 = 7850.0;
  material.damping_time_s = 4e-7;
  material.plastic = false;
  scene.planes.push_back({Vector3(0.03, 0, 0), Vector3::UnitX()});
  return scene;
}

TEST(Vibration, ATapOnSteelIsNone) {
  Random random(39);
  // The fixed end of the handle is a wall; the other end vibrates.
  for (const double x_m : {0.01, 0.055}) {
    for (int run = 0; run < random_cases(2, 40); ++run) {
      Simulation simulation = Simulation::make(steel_handle(), best_instruction_set()).value();
      CouplingState coupling;
      const Hand hand = random_damped_hand(random);
      const double depth_m = random.uniform(0.0, 0.01);
      const TouchingRun tap =
          run_hand(hand, tap_path(0.04, depth_m, 0.2, 0.1, x_m), 500, [&](const DeviceReading& reading) {
            return tick(simulation, coupling, vibrating_device, reading).force_n;
          });
      EXPECT_FALSE(tap.cut) << x_m << " m, " << hand.mass_kg << " kg, " << depth_m << " m";
      EXPECT_GT(tap.strongest_n, 0.5);
    }
  }
}

TEST(Vibration, RidgesThatTheHandCrossesAreNone) {
  Random random(40);
  int strong = 0;
  const int runs = random_cases(60, 1000);
  for (int run = 0; run < runs; ++run) {
    const double pitch_m = random.uniform(0.003, 0.01), height_m = random.uniform(0.0005, 0.003);
    const double pressed_m = random.uniform(0.0, 0.01);
    const double speed_m_per_s = run % 2 == 0 ? 0.1 : random.uniform(0.03, 0.3);
    const int ridges = run % 3 == 0 ? 1 : random.integer(2, 15);
    RigidSurface surface([&](double x_m) {
      if (x_m < 0.0 || x_m > ridges * pitch_m) return 0.0;
      return 0.5 * height_m * (1.0 - std::cos(2.0 * std::numbers::pi * x_m / pitch_m));
    });
    const auto path = [&](int t) {
      const double down_m = std::max(-pressed_m, 0.02 - 0.1 * t * tick_s);
      return Vector3(-0.02 + std::max(0.0, speed_m_per_s * (t - 300) * tick_s), down_m, 0.0);
    };
    const TouchingRun crossing =
        run_hand({}, path, 1500, [&](const DeviceReading& reading) { return surface.touch(reading); });
    EXPECT_FALSE(crossing.cut) << ridges << " ridges of " << pitch_m << " m, " << height_m
                               << " m high, pressed by " << pressed_m << " m at " << speed_m_per_s << " m/s";
    strong += crossing.strongest_n > 1.0;
  }
  EXPECT_GT(strong, runs / 3);
}

// The hand trembles against a flat wall, or sideways over a ridge, which gives two pulses of force per
// period.
TEST(Vibration, ATremorAgainstAStiffMaterialIsNone) {
  Random random(41);
  int strong = 0;
  const int runs = random_cases(60, 1000);
  for (int run = 0; run < runs; ++run) {
    const double frequency_hz = run % 2 == 0 ? 12.0 : random.uniform(4.0, 14.0);
    const double centre_m = random.uniform(-0.01, 0.005), phase = random.uniform(0.0, 6.28);
    const Vector3 amplitude_m =
        0.005 * (run % 3 == 0 ? Vector3(Vector3::UnitX()) : Vector3(Vector3::UnitY()));
    Hand hand;
    if (run % 4 < 2) {  // the hand follows its target closely
      hand.stiffness_n_per_m = 10'000.0;
      hand.damping_n_s_per_m = 60.0;
    }
    RigidSurface surface(
        [&](double x_m) { return run % 3 == 0 ? 0.003 * std::exp(-std::pow(x_m / 0.002, 2)) : 0.0; });
    const auto path = [&](int t) {
      const double angle = 2.0 * std::numbers::pi * frequency_hz * t * tick_s + phase;
      return Vector3(Vector3(0.0, centre_m + 0.03 * std::exp(-t / 100.0), 0.0) +
                     std::sin(angle) * amplitude_m);
    };
    const TouchingRun tremor =
        run_hand(hand, path, 1500, [&](const DeviceReading& reading) { return surface.touch(reading); });
    EXPECT_FALSE(tremor.cut) << frequency_hz << " Hz around " << centre_m << " m along "
                             << amplitude_m.transpose();
    strong += tremor.strongest_n > 1.0;
  }
  EXPECT_GT(strong, runs / 2);
}

}  // namespace
}  // namespace spoonbill
