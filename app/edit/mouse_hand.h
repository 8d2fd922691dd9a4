// The mouse as the hand that holds the virtual handle. Hovering, the tool touches nothing and rests just
// above the surface under the pointer, or beside the body on the plane of the last touch. Pressed, it goes in
// by the strength and follows the pointer in the plane of the screen; the wheel moves that plane. Let go, it
// hovers again. One owner; the thread that draws.
#pragma once

#include <optional>

#include "app/edit/navigation.h"
#include "app/edit/surface_pick.h"
#include "haptic/virtual_device.h"

namespace spoonbill {

struct MouseStroke {
  double radius_m = 0.0;    // of the tool, 0 for a point
  double strength_m = 0.0;  // how deep a press goes in
  bool grips = false;       // holds what it touches: a pull
};

// What the mouse does in one frame, and what it does it to.
struct MouseFrame {
  Pointer pointer;
  bool held = false;  // the button that strokes is down, and the press began on the picture
  Camera camera;
  Viewport viewport;
  const SurfacePick* pick = nullptr;  // must outlive the frame
  MouseStroke stroke;
};

class MouseHand : public InputSource {
 public:
  // At rest at `start_m`, which also gives the first plane to hover on.
  explicit MouseHand(const Vector3& start_m)
      : depth_point_m_(start_m), hover_m_(start_m), target_m_(start_m) {}

  // What is_used() and next_target() go by. The pick must not be null.
  void set_frame(const MouseFrame& frame) { frame_ = frame; }

  bool is_used() override { return frame_.held || !frame_.pointer.moved_px.isZero(); }
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

  // Ends the press as if the button had been let go, until it is pressed again.
  void let_go();

  bool pressing() const { return press_.has_value(); }
  const Vector3& target_m() const { return target_m_; }  // where the handle was last wanted
  bool on_model() const { return on_model_; }            // the last hover was over the body

 private:
  struct Press {
    Vector3 anchor_m;   // where the tool was
    Vector3 inward;     // zero beside the body
    Vector3 pointer_m;  // what the pointer pointed at, in the plane
    double depth_m = 0.0;
    int frames = 0;
  };
  void hover(const Ray& ray, const Camera& camera, const SurfacePick& pick, const MouseStroke& stroke);
  void press(const Ray& ray, const Pointer& pointer, const Camera& camera, const MouseStroke& stroke);

  MouseFrame frame_;
  Vector3 depth_point_m_;
  Vector3 hover_m_;
  Vector3 inward_ = Vector3::Zero();
  bool on_model_ = false;
  std::optional<Press> press_;
  bool must_release_ = false;
  Vector3 target_m_;
};

}  // namespace spoonbill
