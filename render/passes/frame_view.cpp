#include "render/passes/frame_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace spoonbill {

namespace {

Eigen::Vector3f toward_key_light(const Vector3& requested) {
  constexpr double lowest_sine = 0.2;
  const bool usable = requested.allFinite() && requested.norm() > 1e-9;
  Vector3 direction = usable ? requested.normalized() : Vector3::UnitY();
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
  const Eigen::AngleAxisd turn(settings.studio_turn_rad, Vector3::UnitY());
  view.toward_key = toward_key_light(turn * settings.toward_key_light);
  view.studio = settings.studio;
  view.studio_turn_rad = static_cast<float>(settings.studio_turn_rad);
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
}

const char* const whole_viewport_vertex_glsl = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

const char* const key_light_glsl = "uniform vec3 toward_key;\n";

const char* const sphere_shadow_glsl = R"(
uniform vec3 tool_centre;
uniform float tool_radius;

float key_past_sphere(vec3 p) {
  if (tool_radius <= 0.0) return 1.0;
  vec3 to_centre = tool_centre - p;
  float along = dot(to_centre, toward_key);
  float beside = sqrt(max(dot(to_centre, to_centre) - along * along, 0.0));
  float soft = max(along, 0.0) * 0.17 + 0.06 * tool_radius;
  float lit = smoothstep(tool_radius - soft, tool_radius + soft, beside);
  return mix(1.0, lit, smoothstep(-0.3 * tool_radius, 0.3 * tool_radius, along));
}

float sky_past_sphere(vec3 p, vec3 n) {
  if (tool_radius <= 0.0) return 1.0;
  vec3 to_centre = tool_centre - p;
  float d2 = max(dot(to_centre, to_centre), 1e-12);
  float facing = clamp(dot(n, to_centre) * inversesqrt(d2) * 0.85 + 0.15, 0.0, 1.0);
  return 1.0 - 0.8 * facing * min(1.0, tool_radius * tool_radius / d2);
}
)";

}  // namespace spoonbill
