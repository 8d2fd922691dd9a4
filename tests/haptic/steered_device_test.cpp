#include <gtest/gtest.h>

#include <cmath>

#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

HandTarget at_x(double x_m, std::uint32_t buttons = 0) {
  return {{Vector3(x_m, 0, 0), Quaternion::Identity()}, buttons};
}

Pose pose_after(SteeredDevice& device, int ticks) {
  for (int tick = 1; tick < ticks; ++tick) device.read();
  return device.read()->pose();
}

TEST(SteeredDevice, FollowsTheNewestTargetEvenly) {
  auto device = SteeredDevice::make({}, at_x(0.1)).value();
  EXPECT_EQ(pose_after(*device, 10).position_m, Vector3(0.1, 0, 0));
  device->mailbox()->aim(at_x(5.0));
  device->mailbox()->aim(at_x(0.2, button_main));
  EXPECT_EQ(device->read()->buttons, button_main);
  double before_m = 0.1;
  for (int tick = 0; tick < TargetFollower::ticks_to_reach.low; ++tick) {
    const double x_m = device->read()->pose().position_m.x();
    EXPECT_GE(x_m, before_m);
    EXPECT_LT(x_m - before_m, 0.02);
    before_m = x_m;
  }
  EXPECT_NEAR(pose_after(*device, 3000).position_m.x(), 0.2, 1e-9);
}

TEST(TargetFollower, MovesEvenlyAtASlowFrameRate) {
  constexpr int ticks_per_frame = 45;
  constexpr double step_m = 0.0015;
  TargetFollower follower(at_x(0.0));
  double before_m = 0.0;
  for (int frame = 1; frame <= 10; ++frame) {
    follower.aim(at_x(frame * step_m));
    for (int tick = 0; tick < ticks_per_frame; ++tick) {
      const double x_m = follower.step().pose.position_m.x();
      // The first frame has no frame before it whose time is known.
      if (frame > 1) {
        EXPECT_NEAR(x_m - before_m, step_m / ticks_per_frame, 1e-9) << frame << " " << tick;
      }
      before_m = x_m;
    }
    EXPECT_NEAR(before_m, frame * step_m, 1e-12);
  }
}

TEST(TargetFollower, ReachesATargetAfterAPauseWithinAFrame) {
  TargetFollower follower(at_x(0.0));
  for (int tick = 0; tick < 1000; ++tick) follower.step();
  follower.aim(at_x(0.01));
  for (int tick = 0; tick < TargetFollower::ticks_to_reach.high; ++tick) follower.step();
  EXPECT_NEAR(follower.step().pose.position_m.x(), 0.01, 1e-12);
}

TEST(SteeredDevice, FollowsNothingThatIsNotFinite) {
  auto device = SteeredDevice::make({}, at_x(0.1)).value();
  device->mailbox()->aim(at_x(std::nan("")));
  EXPECT_EQ(pose_after(*device, 100).position_m, Vector3(0.1, 0, 0));
  EXPECT_FALSE(SteeredDevice::make({}, at_x(std::nan(""))).ok());
}

// An input source whose values the test sets.
struct Source : InputSource {
  bool is_used() override { return used; }
  HandTarget next_target(const HandTarget& current, double) override {
    ++asked;
    return at_x(current.pose.position_m.x() + step_m);
  }

  bool used = false;
  double step_m = 0.0;
  int asked = 0;
};

TEST(HandInputs, TheSourceThatWasUsedLastLeads) {
  Source mouse, cap;
  mouse.step_m = 1.0;
  cap.step_m = 0.01;
  const auto mailbox = std::make_shared<TargetMailbox>(at_x(0.0));
  HandInputs inputs(mailbox, at_x(0.0), mouse);
  const auto frame = [&] {
    inputs.update(mouse, 0.02);
    inputs.update(cap, 0.02);
    const HandTarget* target = mailbox->receive();
    return target != nullptr ? target->pose.position_m.x() : -1.0;
  };
  EXPECT_EQ(frame(), 1.0);
  EXPECT_EQ(cap.asked, 0);
  cap.used = true;
  EXPECT_EQ(frame(), 2.01);  // the cap continues from the last target of the mouse
  cap.used = false;
  EXPECT_NEAR(frame(), 2.02, 1e-12);
  EXPECT_EQ(mouse.asked, 2);
  mouse.used = true;
  EXPECT_NEAR(frame(), 3.02, 1e-12);
}

}  // namespace
}  // namespace spoonbill
