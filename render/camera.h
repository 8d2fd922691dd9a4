// The camera and its projection to the window: plain data and pure functions, in metres, radians and pixels.
// World: y up. Pixels: origin at the top left corner, x right, y down.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "engine/base/geometry.h"

namespace spoonbill {

// A camera that looks at a target from a distance. At yaw = pitch = 0 the eye is in front (+z) and looks
// along -z. Yaw turns the eye around y toward +x, and pitch raises the eye.
struct Camera {
  Vector3 target_m = Vector3::Zero();
  double distance_m = 0.3;
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double vertical_field_of_view_rad = 0.35;  // 20 degrees: a long lens with little perspective distortion
};

enum class StandardView { perspective, front, back, left, right, top, bottom };

struct Rectangle {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  // pixels
};

// The size of a frame and the part of it that no panel covers.
struct Viewport {
  int width_px = 0;
  int height_px = 0;
  Rectangle free_px;
};

// Returns the viewport of a window with a panel at its left or right edge. If `panel_px` is empty, the whole
// window is free.
Viewport make_viewport(int width_px, int height_px, const Rectangle& panel_px);

// Returns the camera turned to a standard view, with the same target, distance and lens.
Camera look_from(const Camera& camera, StandardView view);

// Returns the camera moved, without rotation, so that the box is centred in the area that no panel covers
// (Viewport::free_px) and fills two thirds of this area in the tighter direction. An empty box leaves the
// camera unchanged.
Camera frame(const Camera& camera, const Box& box, const Viewport& viewport);
// Does the same for points, which fill the given fraction of the area.
Camera frame(const Camera& camera, std::span<const Vector3> points_m, const Viewport& viewport,
             double filled_fraction);

Vector3 eye_position(const Camera& camera);

// Returns the unit vectors of the eye in the world as columns: right, up, and back (toward the person).
Eigen::Matrix3d eye_axes(const Camera& camera);

Eigen::Matrix4d view_matrix(const Camera& camera);

// Returns the perspective projection to the clip space of GL, with its centre in the centre of the area that
// no panel covers (Viewport::free_px).
Eigen::Matrix4d projection_matrix(const Camera& camera, const Viewport& viewport);

// Returns the length in pixels of one metre at the distance of the target.
double pixels_per_metre(const Camera& camera, const Viewport& viewport);

// Returns the position of a point in pixels; empty for a point behind the eye.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Viewport& viewport,
                                       const Vector3& point_m);

// A ray from the eye. The direction is a unit vector.
struct Ray {
  Vector3 origin_m;
  Vector3 direction;
};
Ray ray_through(const Camera& camera, const Viewport& viewport, const Eigen::Vector2d& pixel);

// Returns the point of the horizontal plane at `height_m` that a pixel shows; empty if the pixel does not
// show the plane.
std::optional<Vector3> point_on_height(const Camera& camera, const Viewport& viewport,
                                       const Eigen::Vector2d& pixel, double height_m);

}  // namespace spoonbill
