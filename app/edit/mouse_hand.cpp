#include "app/edit/mouse_hand.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

// Above the surface, so that hovering never touches.
constexpr double hover_gap_m = 0.001;

// A press takes a quarter of a second to reach its depth.
constexpr int frames_to_depth = 15;
constexpr double depth_per_notch_m = 0.001;

// A grip must touch first, wherever the strength is set.
constexpr double grip_depth_m = 2.0 * hover_gap_m;

// Where the ray meets the plane through `point_m` that faces the camera; the point itself where it does not.
Vector3 on_screen_plane(const Ray& ray, const Camera& camera, const Vector3& point_m) {
  const Vector3 back = eye_axes(camera).col(2);
  const double slope = ray.direction.dot(back);
  if (std::abs(slope) < 1e-6) return point_m;
  return ray.origin_m + ((point_m - ray.origin_m).dot(back) / slope) * ray.direction;
}

}  // namespace

HandTarget MouseHand::next_target(const HandTarget&, double) {
  const auto& [pointer, held, camera, viewport, pick, stroke] = frame_;
  const Ray ray = ray_through(camera, viewport, pointer.position_px);
  if (!held) must_release_ = false;
  const bool pressed = held && !must_release_;
  if (pressed && !press_) press_ = Press{hover_m_, inward_, on_screen_plane(ray, camera, hover_m_), 0.0, 0};
  if (!pressed) press_.reset();
  if (press_) {
    press(ray, pointer, camera, stroke);
  } else {
    hover(ray, camera, *pick, stroke);
  }
  const std::uint32_t gripping = stroke.grips ? button_main : 0U;
  return {{target_m_, Quaternion::Identity()}, press_ ? gripping : button_hover};
}

void MouseHand::let_go() {
  must_release_ = press_.has_value();
  press_.reset();
}

void MouseHand::hover(const Ray& ray, const Camera& camera, const SurfacePick& pick,
                      const MouseStroke& stroke) {
  const auto touch = pick.first_touch(ray, stroke.radius_m);
  on_model_ = touch.has_value();
  if (touch) {
    hover_m_ = touch->centre_m + hover_gap_m * touch->outward;
    inward_ = -touch->outward;
    depth_point_m_ = touch->centre_m;
  } else {
    hover_m_ = on_screen_plane(ray, camera, depth_point_m_);
    inward_.setZero();
  }
  target_m_ = hover_m_;
}

void MouseHand::press(const Ray& ray, const Pointer& pointer, const Camera& camera,
                      const MouseStroke& stroke) {
  Press& press = *press_;
  press.frames = std::min(press.frames + 1, frames_to_depth);
  press.depth_m += depth_per_notch_m * pointer.wheel;
  const double share = static_cast<double>(press.frames) / frames_to_depth;
  const double deep = stroke.grips ? grip_depth_m : hover_gap_m + stroke.strength_m;
  const Vector3 dragged = on_screen_plane(ray, camera, press.anchor_m) - press.pointer_m;
  const Vector3 away = -eye_axes(camera).col(2);
  target_m_ = press.anchor_m + dragged + share * deep * press.inward + press.depth_m * away;
}

}  // namespace spoonbill
