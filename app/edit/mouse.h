// The mouse, which moves the camera, picks the point of the surface under the pointer, and sets the position
// of the tool.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "haptic/virtual_device.h"
#include "render/camera.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

// Mouse navigation as in a modelling program. The wheel zooms in every preset, except during a stroke.
//   Rhino: the right button orbits, with Shift pans, with Ctrl zooms.
//   Blender: the middle button orbits, with Shift pans, with Ctrl zooms.
//   SculptGL: the right button orbits, as does the left one if the drag began beside the model.
//     The middle button pans.
enum class NavigationPreset { rhino, blender, sculptgl };

inline constexpr std::array<const char*, 3> navigation_names = {"rhino", "blender", "sculptgl"};

// Returns the preset of this name.
Result<NavigationPreset> find_navigation(const std::string& name);

// State of the mouse in a frame. Positions are in pixels from the upper left corner of the window.
struct Pointer {
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d moved_px = Eigen::Vector2d::Zero();  // motion since the last frame
  double wheel = 0.0;  // turn of the wheel in notches, positive away from the user
  bool left = false, middle = false, right = false;  // true while the button is pressed
  bool ctrl = false, shift = false, alt = false;
};

enum class CameraMotion { none, orbit, pan, zoom };

// Returns the camera motion that the pressed buttons select. `on_model` is true if the drag began on the
// model.
CameraMotion camera_motion(NavigationPreset preset, const Pointer& pointer, bool on_model);

// Returns the camera after a motion of the pointer. An orbit turns the camera about its target.
Camera move_camera_by(const Camera& camera, CameraMotion motion, const Eigen::Vector2d& moved_px,
                      const Viewport& viewport);

// Returns the camera after a zoom. One notch away from the user reduces the distance by a tenth.
Camera zoom_camera(const Camera& camera, double notches);

// First contact between a body and a tool that moves along a ray.
struct PickedPoint {
  Vector3 centre_m;  // centre of the tool at first contact
  Vector3 outward;   // unit vector from the touched point to the tool's centre
};

// Finds where a tool that moves along a ray first touches a body. The contact gives the tool's distance from
// the camera, which the mouse does not give. One owner: the thread that draws.
class SurfacePick {
 public:
  // Samples the current surfaces. The sampling grid of a surface is rebuilt only if the knots, the trim loops
  // or the necessary number of samples change. Surfaces that cannot be evaluated are not picked.
  void update(const Snapshot& snapshot);

  // Returns the first contact of a sphere of this radius that moves along the ray; empty if the sphere misses
  // all surfaces. Each sample point of a surface counts as a small ball, so that the sphere does not pass
  // between the samples; the sphere then rests on the triangles at the sample point.
  std::optional<PickedPoint> first_touch(const Ray& ray, double radius_m) const;

 private:
  struct Sampled {
    TessellatedSurface surface;
    double ball_m = 0.0;  // radius of the ball at each vertex
    std::vector<std::uint32_t> vertices;
    std::uint64_t topology = 0;  // topology_version() of the surface when `vertices` was made
  };
  static void update_vertices(Sampled& sampled);
  static Vector3 find_nearest(const Sampled& sampled, std::uint32_t vertex, const Vector3& to);

  std::vector<Sampled> surfaces_;
};

// Settings of a stroke.
struct MouseStroke {
  double radius_m = 0.0;    // radius of the tool, 0 for a point
  double strength_m = 0.0;  // depth of a press
  bool grips = false;       // true if the tool attaches to the body at first touch, as for a pull
};

// Input of one frame: the mouse, the view and the surfaces.
struct MouseFrame {
  Pointer pointer;
  bool is_stroking = false;  // true while the left button is down and was pressed on the picture
  Camera camera;
  Viewport viewport;
  const SurfacePick* pick = nullptr;  // sampled surfaces; must outlive this object
  MouseStroke stroke;
};

// The mouse as the hand that moves the tool. While hovering, the tool follows the pointer 1 mm above the
// surface. Beside the body, it moves parallel to the screen, in the plane of its last position at the
// surface. A press pushes the tool into the body within a quarter of a second, by MouseStroke::strength_m. A
// drag then moves the tool parallel to the screen. The wheel moves it in depth, and so does a drag with Alt:
// up is away from the eye. The main button is down during a press. One owner: the thread that draws.
class MouseHand : public InputSource {
 public:
  // The tool starts at rest at `start_m`. Until it has hovered over a body, it moves in the plane through
  // `start_m` that is parallel to the screen.
  explicit MouseHand(const Vector3& start_m)
      : depth_point_m_(start_m), hover_m_(start_m), target_m_(start_m) {}

  // Sets the input that is_used() and next_target() use. frame.pick must not be null.
  void set_frame(const MouseFrame& frame) { frame_ = frame; }

  bool is_used() override { return frame_.is_stroking || !frame_.pointer.moved_px.isZero(); }
  HandTarget next_target(const HandTarget& current, double elapsed_s) override;

  // Ends the press as if the button had been released. A new press begins only when the button is pressed
  // again.
  void release_press();

  bool is_pressing() const { return press_.has_value(); }
  const Vector3& target_m() const { return target_m_; }  // last target position of the tool
  bool on_model() const { return is_on_model_; }         // true if the tool last hovered over a body

 private:
  struct Press {
    Vector3 anchor_m;  // position of the tool at the start of the press
    Vector3 inward;    // unit vector into the body; zero if the press began beside the body
    // Point under the pointer in the last frame, in the plane through anchor_m parallel to the screen.
    Vector3 pointer_m;
    Vector3 drag_m = Vector3::Zero();  // so far, parallel to the screen
    double depth_m = 0.0;              // away from the eye
    double seconds = 0.0;              // since the start of the press
  };
  void hover(const Ray& ray, const Camera& camera, const SurfacePick& pick, const MouseStroke& stroke);
  void press(const Ray& ray, const Pointer& pointer, const Camera& camera, const MouseStroke& stroke,
             double elapsed_s);

  MouseFrame frame_;
  Vector3 depth_point_m_;
  Vector3 hover_m_;
  Vector3 inward_ = Vector3::Zero();
  bool is_on_model_ = false;
  std::optional<Press> press_;
  bool must_release_ = false;
  Vector3 target_m_;
};

}  // namespace spoonbill
