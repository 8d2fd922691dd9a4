#include "haptic/watched_device.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace spoonbill {
namespace {

// A device that stores the magnitude of the force. Any thread may read it.
class HeldForce : public Device {
 public:
  const DeviceSpecification& specification() const override { return limits_; }
  std::optional<DeviceReading> read() override { return DeviceReading{}; }
  void set_force(const Vector3& force_n) override {
    force_n_ = force_n.norm();
    ++writes_;
  }
  double force_n() const { return force_n_; }
  int writes() const { return writes_; }

 private:
  DeviceSpecification limits_;
  std::atomic<double> force_n_{0.0};
  std::atomic<int> writes_{0};
};

constexpr std::int64_t watched_tick_ns = 1'000'000;
const Vector3 pushing_n(1.0, 0.0, 0.0);

// Runs `ticks` ticks of the loop, one per millisecond of the test's clock, each followed by a check of the
// watchdog. Returns the time of the last check.
std::int64_t push_until_stop(WatchedDevice& watched, int ticks) {
  std::int64_t now_ns = 0;
  for (int k = 0; k < ticks; ++k) {
    watched.set_force(pushing_n);
    watched.check(now_ns += watched_tick_ns);
  }
  return now_ns;
}

TEST(WatchedDevice, WritesZeroWithinTwelveTicksOfTheLastForceAndNotBeforeTen) {
  HeldForce device;
  WatchedDevice watched(device);
  std::int64_t now_ns = push_until_stop(watched, 1000);
  EXPECT_FALSE(watched.consume_cut());
  int ticks = 0;
  while (device.force_n() != 0.0) {
    watched.check(now_ns += watched_tick_ns);
    ASSERT_LE(++ticks, 12);
  }
  EXPECT_GE(ticks, 10);
  const int writes = device.writes();
  for (int k = 0; k < 100; ++k) watched.check(now_ns += watched_tick_ns);
  EXPECT_EQ(device.writes(), writes) << "zero is written once";
}

TEST(WatchedDevice, AfterACutNoForcePassesUntilTheLoopKnows) {
  HeldForce device;
  WatchedDevice watched(device);
  std::int64_t now_ns = push_until_stop(watched, 10);
  watched.check(now_ns += watchdog_limit_ns);
  EXPECT_EQ(device.force_n(), 0.0);
  watched.set_force(pushing_n);
  EXPECT_EQ(device.force_n(), 0.0);
  EXPECT_TRUE(watched.consume_cut());
  EXPECT_FALSE(watched.consume_cut());
  watched.set_force(pushing_n);
  EXPECT_EQ(device.force_n(), 1.0);
}

TEST(WatchedDevice, ASuspendedMachineGetsZeroAtTheFirstCheckAfterTheResume) {
  HeldForce device;
  WatchedDevice watched(device);
  const std::int64_t now_ns = push_until_stop(watched, 10);
  watched.check(now_ns + 3'600'000'000'000);
  EXPECT_EQ(device.force_n(), 0.0);
}

TEST(WatchedDevice, DoesNotTouchADeviceThatHasHadNoForce) {
  HeldForce device;
  WatchedDevice watched(device);
  watched.check(watchdog_limit_ns * 100);
  EXPECT_EQ(device.writes(), 0);
  EXPECT_FALSE(watched.consume_cut());
}

TEST(WatchedDeviceThread, CutsAForceThatIsNotRenewed) {
  HeldForce device;
  WatchedDevice watched(device);
  ASSERT_TRUE(watched.start(false));
  watched.set_force(pushing_n);
  while (device.force_n() != 0.0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(watched.consume_cut());
  watched.stop();
}

}  // namespace
}  // namespace spoonbill
