#include "haptic/device.h"

#include <gtest/gtest.h>

#include <limits>

#include "haptic/virtual_device.h"
#include "tests/haptic/sample_recording.h"

namespace spoonbill {
namespace {

TEST(DeviceReading, RoundsToNanometresAndBillionths) {
  const Pose pose{Vector3(0.0123456784, -0.0123456786, 1.0), Quaternion(0.5, 0.5, -0.5, 0.5)};
  const DeviceReading reading = DeviceReading::from(pose, 3);
  EXPECT_EQ(reading.position_nm[0], 12345678);
  EXPECT_EQ(reading.position_nm[1], -12345679);
  EXPECT_EQ(reading.position_nm[2], 1000000000);
  EXPECT_EQ(reading.orientation_e9[1], -500000000);
  EXPECT_EQ(reading.buttons, 3u);
}

TEST(DeviceReading, KeepsItselfThroughAPose) {
  for (const DeviceReading& reading : sample_readings(2000, 3)) {
    const DeviceReading again = DeviceReading::from(reading.pose(), reading.buttons);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(again.position_nm[axis], reading.position_nm[axis]);
    EXPECT_EQ(again.buttons, reading.buttons);
    // Four roundings by up to half a billionth change the length of the quaternion by up to one, and pose()
    // makes the length 1 again.
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(again.orientation_e9[k], reading.orientation_e9[k], 1);
    EXPECT_NEAR(reading.pose().orientation.norm(), 1.0, 1e-15);
  }
}

TEST(DeviceReading, NeverHandsOnGarbage) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const DeviceReading reading =
      DeviceReading::from({Vector3(nan, infinity, 1e300), Quaternion(nan, 0, 0, 0)}, 0);
  EXPECT_EQ(reading.position_nm[2], reading_limit_nm);
  EXPECT_FALSE(reading.is_valid());
  const Quaternion upright = Quaternion::Identity();
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_FALSE(DeviceReading::from({Vector3(0, bad, 0), upright}, 0).is_valid());
    EXPECT_FALSE(DeviceReading::from({Vector3::Zero(), Quaternion(1, 0, bad, 0)}, 0).is_valid());
  }
  EXPECT_FALSE(DeviceReading::from({Vector3::Zero(), Quaternion(0, 0, 0, 0)}, 0).is_valid());
  EXPECT_TRUE(DeviceReading::from({Vector3(1e300, 0, 0), upright}, 0).is_valid());
  DeviceReading empty;
  empty.orientation_e9[3] = 0;
  EXPECT_EQ(empty.pose().orientation.w(), 1.0);
}

TEST(PlaybackDevice, ReturnsTheReadingsAndThenTheLast) {
  const std::vector<DeviceReading> readings = sample_readings(3, 1);
  PlaybackDevice device({}, readings);
  for (const DeviceReading& reading : readings) {
    EXPECT_FALSE(device.finished());
    EXPECT_EQ(device.read(), reading);
  }
  EXPECT_TRUE(device.finished());
  EXPECT_EQ(device.read(), readings.back());
  PlaybackDevice silent({}, {});
  EXPECT_EQ(silent.read(), DeviceReading{});
}

}  // namespace
}  // namespace spoonbill
