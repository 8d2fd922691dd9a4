// Moving the camera with the mouse, as the programs do that designers come from. Pure functions.
#pragma once

#include <array>
#include <string>

#include "engine/base/result.h"
#include "render/camera.h"

namespace spoonbill {

// Rhino: right orbits, Shift+right pans, Ctrl+right or the wheel zooms. Blender: middle orbits, Shift+middle
// pans, Ctrl+middle or the wheel zooms. SculptGL: right, or left beside the model, orbits, middle pans, the
// wheel zooms.
enum class NavigationPreset { rhino, blender, sculptgl };

inline constexpr std::array<const char*, 3> navigation_names = {"rhino", "blender", "sculptgl"};

Result<NavigationPreset> navigation_named(const std::string& name);

struct Pointer {
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d moved_px = Eigen::Vector2d::Zero();  // since the last frame
  double wheel = 0.0;                                  // notches, away from the person is positive
  bool left = false, middle = false, right = false;    // held
  bool ctrl = false, shift = false;
};

enum class CameraMotion { none, orbit, pan, zoom };

// What the held buttons mean. `on_model`: whether the drag began on the model.
CameraMotion camera_motion(NavigationPreset preset, const Pointer& pointer, bool on_model);

// The camera after the pointer's move. Orbiting turns it about its target.
Camera moved(const Camera& camera, CameraMotion motion, const Eigen::Vector2d& moved_px,
             const Viewport& viewport);

// A notch of the wheel away from the person comes a tenth nearer.
Camera zoomed(const Camera& camera, double notches);

}  // namespace spoonbill
