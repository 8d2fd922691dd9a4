#include "app/edit/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spoonbill {
namespace {

constexpr double radians_per_px = 0.008;
constexpr double pitch_limit_rad = 89.0 * std::numbers::pi / 180.0;
constexpr double nearest_m = 0.005;
constexpr double farthest_m = 50.0;

Camera at_distance(Camera camera, double factor) {
  camera.distance_m = std::clamp(camera.distance_m * factor, nearest_m, farthest_m);
  return camera;
}

CameraMotion with_modifiers(const Pointer& pointer) {
  if (pointer.shift) return CameraMotion::pan;
  return pointer.ctrl ? CameraMotion::zoom : CameraMotion::orbit;
}

}  // namespace

Result<NavigationPreset> navigation_named(const std::string& name) {
  for (std::size_t i = 0; i < navigation_names.size(); ++i) {
    if (name == navigation_names[i]) return static_cast<NavigationPreset>(i);
  }
  return Error{"navigation is \"" + name + "\", must be rhino, blender or sculptgl"};
}

CameraMotion camera_motion(NavigationPreset preset, const Pointer& pointer, bool on_model) {
  switch (preset) {
    case NavigationPreset::rhino:
      return pointer.right ? with_modifiers(pointer) : CameraMotion::none;
    case NavigationPreset::blender:
      return pointer.middle ? with_modifiers(pointer) : CameraMotion::none;
    case NavigationPreset::sculptgl:
      if (pointer.middle) return CameraMotion::pan;
      return pointer.right || (pointer.left && !on_model) ? CameraMotion::orbit : CameraMotion::none;
  }
  return CameraMotion::none;
}

Camera moved(const Camera& camera, CameraMotion motion, const Eigen::Vector2d& moved_px,
             const Viewport& viewport) {
  Camera next = camera;
  if (motion == CameraMotion::orbit) {
    next.yaw_rad -= radians_per_px * moved_px.x();
    next.pitch_rad =
        std::clamp(next.pitch_rad + radians_per_px * moved_px.y(), -pitch_limit_rad, pitch_limit_rad);
  } else if (motion == CameraMotion::pan) {
    const Eigen::Vector2d moved_m = moved_px / pixels_per_metre(camera, viewport);
    const Eigen::Matrix3d axes = eye_axes(camera);
    next.target_m += -axes.col(0) * moved_m.x() + axes.col(1) * moved_m.y();
  } else if (motion == CameraMotion::zoom) {
    next = at_distance(next, std::exp(radians_per_px * moved_px.y()));
  }
  return next;
}

Camera zoomed(const Camera& camera, double notches) {
  return at_distance(camera, std::pow(0.9, notches));
}

}  // namespace spoonbill
