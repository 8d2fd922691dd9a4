#include "render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Depth range, as multiples of the camera's distance from its target. It includes a tool near the eye and the
// ground far behind the model, with depth steps below a micrometre at arm's length.
constexpr double near_ratio = 0.05;
constexpr double far_ratio = 20.0;

constexpr double usual_filled_fraction = 2.0 / 3.0;

double focal_px(const Camera& camera, const Viewport& viewport) {
  return 0.5 * viewport.height_px / std::tan(0.5 * camera.vertical_field_of_view_rad);
}

Eigen::Vector2d free_centre(const Viewport& viewport) {
  const Rectangle& r = viewport.free_px;
  return {r.x + 0.5 * r.width, r.y + 0.5 * r.height};
}

// Returns the smallest distance of the camera at which every projected point is within a
// rectangle. This rectangle is `viewport.free_px`, scaled by `filled_fraction` about its centre.
double fitting_distance(const Camera& camera, std::span<const Vector3> points_m, const Viewport& viewport,
                        double filled_fraction) {
  const Eigen::Matrix3d axes = eye_axes(camera);
  const double focal = focal_px(camera, viewport);
  const double half_width = 0.5 * filled_fraction * viewport.free_px.width;
  const double half_height = 0.5 * filled_fraction * viewport.free_px.height;
  double distance = 0.0;
  for (const Vector3& point_m : points_m) {
    const Vector3 local = axes.transpose() * (point_m - camera.target_m);
    const double needed =
        focal * std::max(std::abs(local.x()) / half_width, std::abs(local.y()) / half_height);
    distance = std::max(distance, local.z() + needed);
  }
  return distance;
}

// Returns the offset, in pixels, from the centre of `viewport.free_px` to the centre of the rectangle around
// the projected points.
Eigen::Vector2d projected_offset(const Camera& camera, std::span<const Vector3> points_m,
                                 const Viewport& viewport) {
  Box2 pixels;
  for (const Vector3& point_m : points_m) {
    if (const auto pixel = project(camera, viewport, point_m)) pixels.include(*pixel);
  }
  return pixels.centre() - free_centre(viewport);
}

}  // namespace

Viewport make_viewport(int width_px, int height_px, const Rectangle& panel_px) {
  Viewport viewport{width_px, height_px, {0.0, 0.0, double(width_px), double(height_px)}};
  const bool has_panel = panel_px.width > 0.0 && panel_px.height > 0.0;
  if (!has_panel) return viewport;
  const double left = std::max(0.0, panel_px.x);
  const double right = std::max(0.0, width_px - (panel_px.x + panel_px.width));
  if (right >= left) {
    viewport.free_px.x = width_px - right;
    viewport.free_px.width = right;
  } else {
    viewport.free_px.width = left;
  }
  // A panel may cover the whole window. This minimum width keeps the projection defined.
  viewport.free_px.width = std::max(viewport.free_px.width, 1.0);
  return viewport;
}

Camera look_from(const Camera& camera, StandardView view) {
  constexpr double quarter = 0.5 * std::numbers::pi;
  Camera turned = camera;
  turned.yaw_rad = 0.0;
  turned.pitch_rad = 0.0;
  switch (view) {
    case StandardView::perspective:
      turned.yaw_rad = 0.42;
      turned.pitch_rad = 0.44;
      break;
    case StandardView::front:
      break;
    case StandardView::back:
      turned.yaw_rad = 2.0 * quarter;
      break;
    case StandardView::left:
      turned.yaw_rad = -quarter;
      break;
    case StandardView::right:
      turned.yaw_rad = quarter;
      break;
    case StandardView::top:
      turned.pitch_rad = quarter;
      break;
    case StandardView::bottom:
      turned.pitch_rad = -quarter;
      break;
  }
  return turned;
}

Camera frame(const Camera& camera, const Box& box, const Viewport& viewport) {
  if (box.is_empty()) return camera;
  std::array<Vector3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = box.corner(i);
  return frame(camera, corners, viewport, usual_filled_fraction);
}

Camera frame(const Camera& camera, std::span<const Vector3> points_m, const Viewport& viewport,
             double filled_fraction) {
  SPOONBILL_ASSERT(filled_fraction > 0.0);
  Box box;
  for (const Vector3& point_m : points_m) box.include(point_m);
  if (box.is_empty()) return camera;
  Camera framed = camera;
  framed.target_m = box.centre();
  const double smallest_distance = 1e-6;
  // The centre of the projected box moves with the distance, because perspective enlarges the near side.
  // Twelve iterations converge below a hundredth of a pixel.
  for (int round = 0; round < 12; ++round) {
    framed.distance_m =
        std::max(smallest_distance, fitting_distance(framed, points_m, viewport, filled_fraction));
    const Eigen::Vector2d offset =
        projected_offset(framed, points_m, viewport) / pixels_per_metre(framed, viewport);
    const Eigen::Matrix3d axes = eye_axes(framed);
    framed.target_m += axes.col(0) * offset.x() - axes.col(1) * offset.y();
  }
  framed.distance_m =
      std::max(smallest_distance, fitting_distance(framed, points_m, viewport, filled_fraction));
  return framed;
}

Eigen::Matrix3d eye_axes(const Camera& camera) {
  return (Eigen::AngleAxisd(camera.yaw_rad, Vector3::UnitY()) *
          Eigen::AngleAxisd(-camera.pitch_rad, Vector3::UnitX()))
      .toRotationMatrix();
}

Vector3 eye_position(const Camera& camera) {
  return camera.target_m + camera.distance_m * eye_axes(camera).col(2);
}

Eigen::Matrix4d view_matrix(const Camera& camera) {
  const Eigen::Matrix3d turn = eye_axes(camera).transpose();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = turn;
  view.topRightCorner<3, 1>() = -turn * eye_position(camera);
  return view;
}

Eigen::Matrix4d projection_matrix(const Camera& camera, const Viewport& viewport) {
  SPOONBILL_ASSERT(viewport.width_px > 0 && viewport.height_px > 0);
  const double focal = focal_px(camera, viewport);
  const Eigen::Vector2d centre = free_centre(viewport);
  const double near_m = near_ratio * camera.distance_m;
  const double far_m = far_ratio * camera.distance_m;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = 2.0 * focal / viewport.width_px;
  projection(1, 1) = 2.0 * focal / viewport.height_px;
  projection(0, 2) = -(2.0 * centre.x() / viewport.width_px - 1.0);
  projection(1, 2) = -(1.0 - 2.0 * centre.y() / viewport.height_px);
  projection(2, 2) = -(far_m + near_m) / (far_m - near_m);
  projection(2, 3) = -2.0 * far_m * near_m / (far_m - near_m);
  projection(3, 2) = -1.0;
  return projection;
}

double pixels_per_metre(const Camera& camera, const Viewport& viewport) {
  return focal_px(camera, viewport) / camera.distance_m;
}

std::optional<Eigen::Vector2d> project(const Camera& camera, const Viewport& viewport,
                                       const Vector3& point_m) {
  SPOONBILL_ASSERT(viewport.width_px > 0 && viewport.height_px > 0);
  const Vector3 local = eye_axes(camera).transpose() * (point_m - eye_position(camera));
  const double depth = -local.z();
  if (depth <= 1e-9) return std::nullopt;
  const double scale = focal_px(camera, viewport) / depth;
  return free_centre(viewport) + Eigen::Vector2d(scale * local.x(), -scale * local.y());
}

Ray ray_through(const Camera& camera, const Viewport& viewport, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d offset = (pixel - free_centre(viewport)) / focal_px(camera, viewport);
  const Vector3 direction = eye_axes(camera) * Vector3(offset.x(), -offset.y(), -1.0);
  return {eye_position(camera), direction.normalized()};
}

std::optional<Vector3> point_on_height(const Camera& camera, const Viewport& viewport,
                                       const Eigen::Vector2d& pixel, double height_m) {
  const Ray ray = ray_through(camera, viewport, pixel);
  const double rise = height_m - ray.origin_m.y();
  if (std::abs(ray.direction.y()) < 1e-9 || rise / ray.direction.y() <= 0.0) return std::nullopt;
  return Vector3(ray.origin_m + ray.direction * (rise / ray.direction.y()));
}

}  // namespace spoonbill
