// The mouse as the hand of a person who trains: it moves and turns a spoon, or presses with a finger.
#pragma once

#include "app/edit/mouse.h"
#include "haptic/virtual_device.h"
#include "render/camera.h"

namespace spoonbill {

// Input of one frame for a spoon: the mouse, the keys and the view.
struct SpoonInput {
  Pointer pointer;
  bool is_over_picture = false;  // false while the pointer is over the panel or turns the camera
  Camera camera;
  Viewport viewport;
  double keyed_pitch_rad = 0.0;  // turns by keys since the last frame; positive lifts the front
  double keyed_roll_rad = 0.0;   // positive turns the right side down
  double keyed_depth_m = 0.0;    // toward the person
};

// Moves the bowl of a spoon as the pointer moves, in the upright plane along the handle; the pointer need not
// be on the spoon. The wheel lifts or lowers the front; with Shift it turns the spoon about its handle, with
// Alt it moves the bowl toward the person or away. One owner: the thread that draws.
class SpoonMouse : public InputSource {
 public:
  void set_input(const SpoonInput& input) { input_ = input; }

  bool is_used() override;
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

 private:
  SpoonInput input_;
};

// Ranges in which the mouse and the keys move a spoon from where it was at the start.
inline constexpr Range<double> spoon_place_range_m{-0.3, 0.3};
inline constexpr double spoon_turn_limit_rad = 1.4;  // of the handle from level, and about it

// Presses with a finger as MouseHand moves a tool. The main button is down only while the person marks the
// place. One owner: the thread that draws.
class FingerMouse : public InputSource {
 public:
  explicit FingerMouse(const Vector3& start_m) : hand_(start_m) {}

  // `frame.pick` must not be null.
  void set_frame(const MouseFrame& frame, bool is_marking) {
    hand_.set_frame(frame);
    is_marking_ = is_marking;
  }

  bool is_pressing() const { return hand_.is_pressing(); }
  bool is_used() override { return hand_.is_used() || is_marking_; }
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

 private:
  MouseHand hand_;
  bool is_marking_ = false;
};

}  // namespace spoonbill
