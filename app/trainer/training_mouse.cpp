#include "app/trainer/training_mouse.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/training/exact_angles.h"

namespace spoonbill {
namespace {

constexpr double turn_per_notch_rad = 2.0 * degree_rad;
constexpr double depth_per_wheel_notch_m = 0.002;

// Returns where the ray through a pixel meets the upright plane through a point that contains x; `point_m`
// where the ray runs along the plane.
Vector3 project_to_upright_plane(const Camera& camera, const Viewport& viewport, const Eigen::Vector2d& pixel,
                                 const Vector3& point_m) {
  const Ray ray = ray_through(camera, viewport, pixel);
  constexpr double least_slope = 0.05;
  if (std::abs(ray.direction.z()) < least_slope) return point_m;
  return ray.origin_m + (point_m.z() - ray.origin_m.z()) / ray.direction.z() * ray.direction;
}

double pitch_of(const Quaternion& orientation) {
  return std::asin(std::clamp((orientation * Vector3::UnitX()).y(), -1.0, 1.0));
}

// Returns the part of a turn by which an angle may still change within the limit.
double limit_turn(double angle_rad, double turn_rad) {
  return std::clamp(angle_rad + turn_rad, -spoon_turn_limit_rad, spoon_turn_limit_rad) - angle_rad;
}

}  // namespace

bool SpoonMouse::is_used() {
  return (input_.is_over_picture && (!input_.pointer.moved_px.isZero() || input_.pointer.wheel != 0.0)) ||
         input_.keyed_pitch_rad != 0.0 || input_.keyed_roll_rad != 0.0 || input_.keyed_depth_m != 0.0;
}

HandTarget SpoonMouse::next_target(const HandTarget& current, double) {
  HandTarget target = current;
  const Pointer& pointer = input_.pointer;
  double pitch = input_.keyed_pitch_rad, roll = input_.keyed_roll_rad;
  Vector3& position_m = target.pose.position_m;
  position_m.z() += input_.keyed_depth_m;
  if (input_.is_over_picture) {
    const auto at = [&](const Eigen::Vector2d& pixel) {
      return project_to_upright_plane(input_.camera, input_.viewport, pixel, current.pose.position_m);
    };
    position_m += at(pointer.position_px) - at(pointer.position_px - pointer.moved_px);
    if (pointer.alt) {
      position_m.z() += depth_per_wheel_notch_m * pointer.wheel;
    } else {
      (pointer.shift ? roll : pitch) += turn_per_notch_rad * pointer.wheel;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    position_m[axis] = std::clamp(position_m[axis], spoon_place_range_m.low, spoon_place_range_m.high);
  }
  Quaternion& orientation = target.pose.orientation;
  pitch = limit_turn(pitch_of(orientation), pitch);
  const double rolled = -std::asin(std::clamp((orientation * Vector3::UnitZ()).y(), -1.0, 1.0));
  roll = limit_turn(rolled, roll);
  orientation =
      (turn_about_axis(Vector3::UnitZ(), pitch) * orientation * turn_about_axis(Vector3::UnitX(), roll))
          .normalized();
  target.buttons = 0;
  input_.keyed_pitch_rad = input_.keyed_roll_rad = input_.keyed_depth_m = 0.0;
  return target;
}

HandTarget FingerMouse::next_target(const HandTarget& current, double elapsed_s) {
  HandTarget target = hand_.next_target(current, elapsed_s);
  target.buttons = (target.buttons & button_hover) | (is_marking_ ? button_main : 0u);
  return target;
}

}  // namespace spoonbill
