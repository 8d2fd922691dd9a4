#include "render/passes/frame_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

Eigen::Vector3f toward_key_light(const Vector3& wanted) {
  constexpr double lowest_sine = 0.2;
  const bool usable = wanted.allFinite() && wanted.norm() > 1e-9;
  Vector3 direction = usable ? wanted.normalized() : Vector3::UnitY();
  direction.y() = std::max(direction.y(), lowest_sine);
  return direction.normalized().cast<float>();
}

}  // namespace

FrameView make_frame_view(const ViewSettings& settings, int width_px, int height_px) {
  FrameView view;
  const Camera& camera = settings.camera;
  view.viewport = make_viewport(width_px, height_px, settings.panel_px);
  view.world_to_clip = (projection_matrix(camera, view.viewport) * view_matrix(camera)).cast<float>();
  const Eigen::Matrix3d axes = eye_axes(camera);
  view.eye_m = eye_position(camera).cast<float>();
  view.eye_right = axes.col(0).cast<float>();
  view.eye_up = axes.col(1).cast<float>();
  view.toward_key = toward_key_light(settings.toward_key_light);
  view.ground_y_m = static_cast<float>(settings.ground_y_m);
  view.interface_scale = static_cast<float>(settings.interface_scale);
  view.nearest_depth_m = static_cast<float>(0.06 * camera.distance_m);
  view.pixel_depth_ratio = static_cast<float>(pixels_per_metre(camera, view.viewport) * camera.distance_m);
  return view;
}

void set_frame_uniforms(const Program& program, const FrameView& view) {
  program.set("world_to_clip", view.world_to_clip);
  program.set("eye", view.eye_m);
  program.set("toward_key", view.toward_key);
  program.set("ground_y", view.ground_y_m);
  const Eigen::Vector3f back = view.eye_right.cross(view.eye_up);
  const Eigen::Vector3f up = Eigen::Vector3f::UnitY();
  program.set("toward_fill", (0.75f * view.eye_right + 0.2f * view.eye_up + 0.6f * back).normalized().eval());
  program.set("toward_rim", (0.75f * up - 0.8f * back - 0.35f * view.eye_right).normalized().eval());
  program.set("toward_strip", (0.9f * view.eye_right + 0.25f * view.eye_up + 0.15f * up).normalized().eval());
}

}  // namespace spoonbill
