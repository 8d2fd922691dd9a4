#include "haptic/safe_device.h"

#include <gtest/gtest.h>

namespace spoonbill {
namespace {

// A device that returns the reading set by the test and stores the force it receives.
class Stub : public Device {
 public:
  Stub() { limits.name = "stub"; }
  const DeviceSpecification& specification() const override { return limits; }
  std::optional<DeviceReading> read() override { return reading; }
  void set_force(const Vector3& force_n) override { given_n = force_n; }

  DeviceSpecification limits;
  std::optional<DeviceReading> reading = DeviceReading{};
  Vector3 given_n = Vector3::Constant(1e9);
};

DeviceReading reading_at_x(double x_m, std::uint32_t buttons = 0) {
  return DeviceReading::from({Vector3(x_m, 0, 0), Quaternion::Identity()}, buttons);
}

void run(SafeDevice& safe, double x_n, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) {
    safe.read();
    safe.give(Vector3(x_n, 0, 0), 0);
  }
}

// Runs until the force has ramped up to its full value.
void engage(SafeDevice& safe) {
  run(safe, 0.0, 1000);
  run(safe, 1.0, 100);
}

TEST(SafeDevice, GivesTheForceAndNeverMoreThanTheDeviceMay) {
  Stub stub;
  stub.limits.maximum_force_n = 2.0;
  SafeDevice safe(stub);
  run(safe, 1.0, 100);
  EXPECT_EQ(stub.given_n, Vector3::Zero());  // still off, because the force has not been small yet
  engage(safe);
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  EXPECT_EQ(safe.flags(), safety_flag_none);
  run(safe, 50.0, 100);
  EXPECT_NEAR(stub.given_n.norm(), 2.0, 1e-12);
  EXPECT_EQ(safe.give(Vector3(1.9, 0, 0), 0), stub.given_n);
  safe.give_none(0);
  EXPECT_EQ(stub.given_n, Vector3::Zero());
  EXPECT_EQ(safe.flags(), safety_flag_stale | safety_flag_cut);
}

TEST(SafeDevice, StandsInForADeviceThatDoesNotAnswerWithAHandThatTouchesNothing) {
  DeviceReading far = reading_at_x(0.01), shapeless = reading_at_x(0.01);
  far.position_nm[2] = reading_limit_nm + 1;
  shapeless.orientation_e9[3] = 0;
  for (const std::optional<DeviceReading>& answer :
       {std::optional<DeviceReading>(), std::optional(far), std::optional(shapeless)}) {
    Stub stub;
    SafeDevice safe(stub);
    stub.reading = reading_at_x(0.02, button_main);
    engage(safe);
    ASSERT_NE(stub.given_n, Vector3::Zero());
    EXPECT_FALSE(safe.consume_proxy_reset());
    stub.reading = answer;
    EXPECT_EQ(safe.read(), reading_at_x(0.02, button_hover));
    EXPECT_EQ(safe.give(Vector3(1, 0, 0), 0), Vector3::Zero());
    EXPECT_EQ(stub.given_n, Vector3::Zero());
    EXPECT_EQ(safe.flags(), safety_flag_no_device | safety_flag_cut);
    EXPECT_FALSE(safe.consume_proxy_reset());

    stub.reading = reading_at_x(0.03, button_main);
    EXPECT_EQ(safe.read(), reading_at_x(0.03, button_main));
    EXPECT_TRUE(safe.consume_proxy_reset());
    EXPECT_FALSE(safe.consume_proxy_reset());
    run(safe, 1.0, 100);
    EXPECT_EQ(stub.given_n, Vector3::Zero());
    EXPECT_EQ(safe.flags(), safety_flag_no_device | safety_flag_waiting);
    engage(safe);
    EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  }
}

TEST(SafeDevice, StandsInWithWhatItWasGivenUntilTheDeviceAnswers) {
  Stub stub;
  stub.reading.reset();
  SafeDevice safe(stub, reading_at_x(0.05));
  EXPECT_EQ(safe.read(), reading_at_x(0.05, button_hover));
  safe.give(Vector3(1, 0, 0), 0);
  EXPECT_EQ(stub.given_n, Vector3::Zero());
}

TEST(SafeDevice, AsksForTheProxyToBeResetAfterAStall) {
  Stub stub;
  SafeDevice safe(stub);
  engage(safe);
  safe.read();
  safe.give(Vector3(1, 0, 0), 100);
  EXPECT_EQ(stub.given_n, Vector3::Zero());
  EXPECT_TRUE(safe.consume_proxy_reset());
  safe.request_proxy_reset();
  EXPECT_TRUE(safe.consume_proxy_reset());
  EXPECT_FALSE(safe.consume_proxy_reset());
}

TEST(SafeDevice, TheWorkspaceIsWhereTheHandBeginsOrWhereItIsPut) {
  Stub stub;
  stub.reading = reading_at_x(5.0);
  SafeDevice safe(stub);
  engage(safe);
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  safe.set_workspace_centre(Vector3::Zero());
  run(safe, 1.0, 100);
  EXPECT_EQ(stub.given_n, Vector3::Zero());
  EXPECT_EQ(safe.flags(), safety_flag_outside);
  safe.set_workspace_radius(6.0);
  run(safe, 1.0, 100);
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
}

}  // namespace
}  // namespace spoonbill
