// Tests the mouse as a hand that holds a spoon, or presses with a finger.
#include "app/trainer/training_mouse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/training/exact_angles.h"
#include "haptic/device.h"

namespace spoonbill {
namespace {

SpoonInput still_input() {
  SpoonInput input;
  input.is_over_picture = true;
  input.camera = look_from(Camera(), StandardView::front);
  input.camera.distance_m = 0.5;
  input.viewport = make_viewport(1280, 720, {});
  input.pointer.position_px = {640.0, 360.0};
  return input;
}

HandTarget follow(const SpoonInput& input, const HandTarget& from = {}) {
  SpoonMouse mouse;
  mouse.set_input(input);
  mouse.is_used();
  return mouse.next_target(from, 1.0 / 60.0);
}

double pitch_deg(const HandTarget& target) {
  return std::asin((target.pose.orientation * Vector3::UnitX()).y()) / degree_rad;
}

TEST(SpoonMouse, MovesTheBowlUprightAsThePointerMoves) {
  SpoonInput input = still_input();
  EXPECT_EQ(follow(input).pose.position_m, Vector3::Zero());
  input.pointer.moved_px = {30.0, -40.0};
  const Vector3 moved_m = follow(input).pose.position_m;
  EXPECT_GT(moved_m.x(), 0.0);
  EXPECT_NEAR(moved_m.y() / moved_m.x(), 40.0 / 30.0, 0.02);
  EXPECT_NEAR(moved_m.z(), 0.0, 1e-12);
  input.is_over_picture = false;
  EXPECT_EQ(follow(input).pose.position_m, Vector3::Zero());
}

TEST(SpoonMouse, KeepsTheBowlWithinReach) {
  SpoonInput input = still_input();
  input.pointer.moved_px = {200.0, 100.0};
  HandTarget target;
  for (int k = 0; k < 60; ++k) target = follow(input, target);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_TRUE(spoon_place_range_m.contains(target.pose.position_m[axis]));
}

TEST(SpoonMouse, WheelAndKeysTurnTheSpoonWithinTheirLimit) {
  SpoonInput input = still_input();
  input.pointer.wheel = 1.0;
  EXPECT_NEAR(pitch_deg(follow(input)), 2.0, 1e-9);
  HandTarget target;
  for (int k = 0; k < 200; ++k) target = follow(input, target);
  EXPECT_NEAR(pitch_deg(target), spoon_turn_limit_rad / degree_rad, 1e-6);
  EXPECT_TRUE(is_finite(target));
  input.pointer.shift = true;  // about the handle, which stays level
  const HandTarget rolled = follow(input);
  EXPECT_NEAR(pitch_deg(rolled), 0.0, 1e-9);
  EXPECT_LT((rolled.pose.orientation * Vector3::UnitZ()).y(), 0.0);  // the right side goes down
  SpoonInput keyed = still_input();
  keyed.keyed_pitch_rad = -0.1;
  keyed.keyed_depth_m = 0.002;
  EXPECT_NEAR(pitch_deg(follow(keyed)), -0.1 / degree_rad, 1e-9);
  EXPECT_NEAR(follow(keyed).pose.position_m.z(), 0.002, 1e-12);
}

TEST(FingerMouse, MainButtonIsTheMarkOnly) {
  const SurfacePick nothing;
  MouseFrame frame{{},
                   true,
                   look_from(Camera(), StandardView::front),
                   make_viewport(1280, 720, {}),
                   &nothing,
                   {0.006, 0.006, false}};
  FingerMouse mouse(Vector3::Zero());
  mouse.set_frame(frame, false);
  EXPECT_EQ(mouse.next_target({}, 0.01).buttons & button_main, 0u);
  EXPECT_TRUE(mouse.is_pressing());
  mouse.set_frame(frame, true);
  EXPECT_EQ(mouse.next_target({}, 0.01).buttons & button_main, button_main);
  frame.is_stroking = false;
  mouse.set_frame(frame, false);
  EXPECT_EQ(mouse.next_target({}, 0.01).buttons, button_hover);
}

}  // namespace
}  // namespace spoonbill
