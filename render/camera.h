// The camera and where its picture lies in the window: plain data and pure functions, in metres, radians and
// pixels. World: y up. Pixels: origin at the top left corner, x right, y down.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/base/geometry.h"

namespace spoonbill {

// Looks at the target from a distance. At yaw = pitch = 0 the eye stands in front (+z) and looks along -z;
// yaw turns it around y toward +x, pitch raises it.
struct Camera {
  Vector3 target_m = Vector3::Zero();
  double distance_m = 0.3;
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double vertical_field_of_view_rad = 0.35;  // 20 degrees: a long lens, which keeps proportions honest
};

enum class StandardView { perspective, front, back, left, right, top, bottom };

struct Rectangle {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  // pixels
};

// A frame's size and the part of it that the model has to itself.
struct Viewport {
  int width_px = 0;
  int height_px = 0;
  Rectangle free_px;
};

// The part of the window beside a panel at its left or right edge; the whole window without a panel.
Viewport make_viewport(int width_px, int height_px, const Rectangle& panel_px);

// The standard view's direction, with the camera's target, distance and lens kept.
Camera look_from(const Camera& camera, StandardView view);

// Moves the camera, without turning it, so that the box fills two thirds of the free rectangle in the tighter
// direction and lies in its middle. An empty box leaves the camera as it is.
Camera frame(const Camera& camera, const Box& box, const Viewport& viewport);

Vector3 eye_position(const Camera& camera);

// Unit vectors of the eye in the world: right, up, and back (toward the person).
Eigen::Matrix3d eye_axes(const Camera& camera);

Eigen::Matrix4d view_matrix(const Camera& camera);

// Perspective with its centre in the middle of the free rectangle, to GL's clip space.
Eigen::Matrix4d projection_matrix(const Camera& camera, const Viewport& viewport);

// Pixels that one metre at the target's distance covers.
double pixels_per_metre(const Camera& camera, const Viewport& viewport);

// Where a point appears, in pixels; none behind the eye.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Viewport& viewport,
                                       const Vector3& point_m);

// What a pixel shows lies on this ray, from the eye on; the direction is a unit vector.
struct Ray {
  Vector3 origin_m;
  Vector3 direction;
};
Ray ray_through(const Camera& camera, const Viewport& viewport, const Eigen::Vector2d& pixel);

// The point of the horizontal plane at that height which a pixel shows; none above the horizon.
std::optional<Vector3> point_on_height(const Camera& camera, const Viewport& viewport,
                                       const Eigen::Vector2d& pixel, double height_m);

}  // namespace spoonbill
