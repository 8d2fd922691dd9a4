#include "haptic/safe_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/simulation/simulation.h"
#include "haptic/virtual_device.h"

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
    safe.give(Vector3(x_n, 0, 0));
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
  EXPECT_EQ(stub.given_n, Vector3::Zero());  // still off, because the requested force has not been small yet
  engage(safe);
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  EXPECT_EQ(safe.flags(), safety_flag_none);
  run(safe, 50.0, 100);
  EXPECT_NEAR(stub.given_n.norm(), 2.0, 1e-12);
  EXPECT_EQ(safe.give(Vector3(1.9, 0, 0)), stub.given_n);
  safe.give_none();
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
    EXPECT_EQ(safe.give(Vector3(1, 0, 0)), Vector3::Zero());
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
  safe.give(Vector3(1, 0, 0));
  EXPECT_EQ(stub.given_n, Vector3::Zero());
}

TEST(SafeDevice, AsksForTheProxyToBeResetAfterAStall) {
  Stub stub;
  SafeDevice safe(stub);
  engage(safe);
  EXPECT_EQ(safe.read(8).missed, 8U);
  safe.give(Vector3(1, 0, 0));
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  EXPECT_FALSE(safe.consume_proxy_reset());
  EXPECT_EQ(safe.read(9).missed, 9U);
  EXPECT_TRUE(safe.consume_proxy_reset());  // the reset comes before the simulation advances
  safe.give(Vector3(1, 0, 0));
  EXPECT_EQ(stub.given_n, Vector3::Zero());
  EXPECT_EQ(safe.flags(), safety_flag_stalled | safety_flag_cut);
  EXPECT_FALSE(safe.consume_proxy_reset());
  safe.request_proxy_reset();
  EXPECT_TRUE(safe.consume_proxy_reset());
  EXPECT_FALSE(safe.consume_proxy_reset());
}

TEST(SafeDevice, AHandThatJumpsOnlyPointsAndGetsNoForce) {
  Stub stub;
  stub.reading = reading_at_x(0.0, button_main);
  SafeDevice safe(stub);
  engage(safe);
  const double limit_m = jump_speed_factor * stub.limits.maximum_speed_m_per_s * tick_s;
  stub.reading = reading_at_x(0.045, button_main);
  EXPECT_EQ(safe.read(), reading_at_x(0.045, button_hover));
  EXPECT_FALSE(safe.consume_proxy_reset());
  EXPECT_EQ(safe.give(Vector3(1, 0, 0)), Vector3::Zero());
  EXPECT_EQ(safe.flags(), safety_flag_jumped | safety_flag_cut);
  EXPECT_EQ(safe.read(), reading_at_x(0.045, button_main));
  EXPECT_TRUE(safe.consume_proxy_reset());
  run(safe, 1.0, 100);
  EXPECT_EQ(stub.given_n, Vector3::Zero());  // the force waits until the request is small, as at the start
  engage(safe);
  EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  stub.reading = reading_at_x(0.045 + 1.01 * 3.0 * limit_m, button_main);
  EXPECT_EQ(safe.read(2).buttons, button_hover);  // the motion is too fast even for three ticks
  stub.reading = reading_at_x(0.045 + 4.0 * limit_m, button_main);
  EXPECT_EQ(safe.read().buttons, button_main);
}

TEST(SafeDevice, APoseThatIsNotFiniteGetsNoForceAtOnce) {
  Stub stub;
  SafeDevice safe(stub);
  engage(safe);
  stub.reading = DeviceReading::from({Vector3(std::nan(""), 0, 0), Quaternion::Identity()}, button_main);
  EXPECT_EQ(safe.read().buttons, button_hover);
  EXPECT_EQ(safe.give(Vector3(1, 0, 0)), Vector3::Zero());
  EXPECT_EQ(safe.flags(), safety_flag_no_device | safety_flag_cut);
}

TEST(SafeDevice, PlaybackPassesReadingsUnchangedAndAsksForNoReset) {
  std::vector<DeviceReading> readings = {reading_at_x(0.0), reading_at_x(0.3), reading_at_x(-0.3)};
  readings[1].missed = 40;
  PlaybackDevice device(Stub().limits, readings);
  SafeDevice safe(device);
  for (const DeviceReading& reading : readings) {
    EXPECT_EQ(safe.read(), reading);
    EXPECT_FALSE(safe.consume_proxy_reset());
    safe.give(Vector3::Zero());
  }
}

TEST(SafeDevice, TheSwitchCutsTheForceAtOnceAndLetsItRampInAgain) {
  Stub stub;
  {
    SafeDevice safe(stub);
    engage(safe);
    safe.switch_force(false);
    run(safe, 1.0, 1);
    EXPECT_EQ(stub.given_n, Vector3::Zero());
    EXPECT_EQ(safe.flags(), safety_flag_off | safety_flag_cut);
    EXPECT_FALSE(safe.consume_proxy_reset());  // the tool continues to sculpt
    safe.switch_force(true);
    run(safe, 1.0, 100);
    EXPECT_EQ(stub.given_n, Vector3::Zero());
    engage(safe);
    EXPECT_EQ(stub.given_n, Vector3(1, 0, 0));
  }
  EXPECT_EQ(stub.given_n, Vector3::Zero());  // the destructor of SafeDevice sent zero force
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
