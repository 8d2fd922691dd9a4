// Tests the safety chain and the watchdog against a device, a loop and a machine that fail at random.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "engine/simulation/simulation.h"
#include "haptic/safe_device.h"
#include "haptic/tick.h"
#include "haptic/watched_device.h"
#include "tests/engine/effort.h"
#include "tests/engine/random.h"

namespace spoonbill {
namespace {

constexpr std::int64_t device_tick_ns = 1'000'000;

// A hand that presses a wall at random depths, on a device whose sensor fails at times.
class FaultyDevice : public Device {
 public:
  explicit FaultyDevice(Random& random) : random_(random) { limits_.ramp_time_s = 0.02; }

  const DeviceSpecification& specification() const override { return limits_; }

  std::optional<DeviceReading> read() override {
    // A jump after an invalid reading is not a fault, because the hand may have moved in the meantime.
    const bool was_known = std::exchange(known_, true), has_jumped = std::exchange(jumped_, false);
    fails_ = true;
    Pose pose{position_m_ + slip_m_, Quaternion::Identity()};
    switch (random_.bits() % 2000) {
      case 0:
        pose.position_m[1] = std::numeric_limits<double>::quiet_NaN();
        known_ = false;
        break;
      case 1:
        pose.orientation.w() = std::numeric_limits<double>::infinity();
        known_ = false;
        break;
      case 2:
        pose.position_m += random_.uniform(0.05, 1.0) * random_.direction();
        jumped_ = true;
        fails_ = was_known;
        break;
      case 3:
        known_ = false;
        return {};
      case 4:
        // The sensor loses counts: the position jumps, and all later positions have the same offset.
        if (slip_m_.isZero(0.0)) {
          slip_m_ = random_.uniform(0.05, 0.1) * random_.direction();
        } else {
          slip_m_.setZero();
        }
        pose.position_m = position_m_ + slip_m_;
        fails_ = was_known;
        break;
      default:
        // The return from a jump is itself a jump and a fault.
        fails_ = has_jumped;
    }
    return DeviceReading::from(pose, button_main);
  }

  void set_force(const Vector3& force_n) override { force_n_ = force_n; }

  // Moves the hand by the distance that it covers in a millisecond. Its speed is below the device's limit.
  void move() {
    if (random_.once_in(200)) target_y_m_ = random_.uniform(-0.004, 0.004);
    position_m_.y() += std::clamp(target_y_m_ - position_m_.y(), -2e-4, 2e-4);
  }

  bool fails() const { return fails_; }  // true if the reading of the last read() is faulty
  const Vector3& force_n() const { return force_n_; }

 private:
  Random& random_;
  DeviceSpecification limits_;
  Vector3 position_m_ = Vector3(0.0, 0.004, 0.0);
  double target_y_m_ = 0.004;
  Vector3 slip_m_ = Vector3::Zero();
  bool fails_ = false, jumped_ = false, known_ = false;
  Vector3 force_n_ = Vector3::Zero();
};

// Runs a haptic loop and its device, with the safety chain and the watchdog between them, millisecond by
// millisecond.
struct FaultyRun {
  explicit FaultyRun(Random& source) : random(source), device(source), watched(device), safe(watched) {}

  Random& random;
  FaultyDevice device;
  WatchedDevice watched;
  SafeDevice safe;
  CouplingState coupling;
  std::int64_t now_ns = 0;
  std::uint64_t idle_ticks = 0;   // milliseconds since the last tick of the loop
  std::uint64_t quiet_ticks = 0;  // ticks of the loop since the last fault
  std::uint64_t beyond_limit = 0, not_cut = 0, held = 0, pressed = 0, early = 0;
  std::uint64_t faults = 0, stops = 0, with_force = 0;

  void judge() {
    beyond_limit += !(device.force_n().norm() <= device.specification().maximum_force_n * (1.0 + 1e-12));
    held += idle_ticks >= 12 && !device.force_n().isZero(0.0);
  }

  void run_tick() {
    const bool is_late = idle_ticks >= 9;
    const std::uint64_t cut_ticks = watched.consume_cut() ? stall_ticks - 1 : 0;
    const DeviceReading reading = safe.read(std::max(idle_ticks, cut_ticks));
    const bool is_reset = safe.consume_proxy_reset();
    idle_ticks = 0;
    const Vector3 position_m = reading.pose().position_m;
    const bool touches = (reading.buttons & button_hover) == 0 && !is_reset;
    const Vector3 depth_m(0.0, touches ? std::max(0.0, -position_m.y()) : 0.0, 0.0);
    const TickResult result = couple(coupling, device.specification(), position_m, depth_m, reading.missed);
    safe.give(random.once_in(3000) ? Vector3(Vector3::Constant(std::nan(""))) : result.force_n);
    const bool is_fault = device.fails() || is_late, has_force = !device.force_n().isZero(0.0);
    quiet_ticks = is_fault ? 0 : quiet_ticks + 1;
    faults += is_fault;
    not_cut += is_fault && has_force;
    // After a stall, a jump may be a true motion of the hand, so its reading may press.
    pressed += device.fails() && !is_late && (reading.buttons & button_hover) == 0;
    early += quiet_ticks <= 10 && has_force;
    with_force += has_force;
  }

  // Advances the device by a millisecond. If `loop_runs`, the loop runs a tick.
  void run(bool loop_runs) {
    now_ns += device_tick_ns;
    device.move();
    if (loop_runs) {
      run_tick();
    } else {
      ++idle_ticks;
    }
    watched.check(now_ns);
    judge();
  }

  // Suspends the machine while the device holds the force. The watchdog is the first to run afterwards.
  void suspend() {
    const std::uint64_t ticks = 10 + random.bits() % 100'000;
    now_ns += static_cast<std::int64_t>(ticks) * device_tick_ns;
    idle_ticks += ticks;
    watched.check(now_ns);
    judge();
  }
};

TEST(FaultyDevice, NeverPassesTheLimitAndGetsNoForceAfterAnyFault) {
  const std::uint64_t ticks = is_full_run() ? 1'000'000 : 100'000;
  Random random(23);
  FaultyRun run(random);
  std::uint64_t pause = 0;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (pause == 0 && random.once_in(50)) pause = 1 + random.bits() % 8;      // the loop is late
    if (pause == 0 && random.once_in(1000)) pause = 9 + random.bits() % 100;  // the loop stalls or stops
    if (random.once_in(5000)) run.suspend();
    run.stops += pause >= 12;
    run.run(pause == 0);
    pause -= pause > 0;
  }
  EXPECT_EQ(run.beyond_limit, 0U);
  EXPECT_EQ(run.not_cut, 0U);
  EXPECT_EQ(run.held, 0U);
  EXPECT_EQ(run.pressed, 0U) << "a reading that is at fault must not press";
  EXPECT_EQ(run.early, 0U) << "the force returns only after ten quiet ticks";
  // Checks that each kind of event occurred often enough.
  EXPECT_GT(run.faults, ticks / 2000);
  EXPECT_GT(run.stops, ticks / 2000);
  EXPECT_GT(run.with_force, ticks / 100);
}

}  // namespace
}  // namespace spoonbill
