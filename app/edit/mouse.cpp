#include "app/edit/mouse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/collision/meshes/triangle.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

constexpr double radians_per_px = 0.008;
constexpr double pitch_limit_rad = 89.0 * std::numbers::pi / 180.0;
constexpr double nearest_m = 0.005;
constexpr double farthest_m = 50.0;

Camera scale_distance(Camera camera, double factor) {
  camera.distance_m = std::clamp(camera.distance_m * factor, nearest_m, farthest_m);
  return camera;
}

CameraMotion motion_for_modifiers(const Pointer& pointer) {
  if (pointer.shift) return CameraMotion::pan;
  return pointer.ctrl ? CameraMotion::zoom : CameraMotion::orbit;
}

}  // namespace

Result<NavigationPreset> find_navigation(const std::string& name) {
  for (std::size_t i = 0; i < navigation_names.size(); ++i) {
    if (name == navigation_names[i]) return static_cast<NavigationPreset>(i);
  }
  return Error{ErrorCode::unknown, "navigation is \"" + name + "\", must be rhino, blender or sculptgl",
               "navigation"};
}

CameraMotion camera_motion(NavigationPreset preset, const Pointer& pointer, bool on_model) {
  switch (preset) {
    case NavigationPreset::rhino:
      return pointer.right ? motion_for_modifiers(pointer) : CameraMotion::none;
    case NavigationPreset::blender:
      return pointer.middle ? motion_for_modifiers(pointer) : CameraMotion::none;
    case NavigationPreset::sculptgl:
      if (pointer.middle) return CameraMotion::pan;
      return pointer.right || (pointer.left && !on_model) ? CameraMotion::orbit : CameraMotion::none;
  }
  return CameraMotion::none;
}

Camera move_camera_by(const Camera& camera, CameraMotion motion, const Eigen::Vector2d& moved_px,
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
    next = scale_distance(next, std::exp(radians_per_px * moved_px.y()));
  }
  return next;
}

Camera zoom_camera(const Camera& camera, double notches) {
  return scale_distance(camera, std::pow(0.9, notches));
}

namespace {

// Sampling of surfaces for picking: the edges of cells are at most 1 mm long and deviate by at most 0.1 mm
// from the surface.
constexpr double picking_px_per_m = 1000.0;
constexpr SamplingTarget target{1.0, 0.1};

// Returns the t > 0 at which the ray enters the sphere of radius `reach` around `point`. Returns nullopt if
// the ray misses the sphere, or starts inside it or beyond it.
std::optional<double> first_crossing(const Ray& ray, const Vector3& point, double reach) {
  const Vector3 to_point = point - ray.origin_m;
  const double along = to_point.dot(ray.direction);
  const double beside_squared = to_point.squaredNorm() - along * along;
  const double half_chord_squared = reach * reach - beside_squared;
  if (half_chord_squared < 0.0) return std::nullopt;
  const double t = along - std::sqrt(half_chord_squared);
  return t > 0.0 ? std::optional<double>(t) : std::nullopt;
}

Vector3 position(const GridSamples<float>& samples, std::size_t i) {
  return {samples.x[i], samples.y[i], samples.z[i]};
}

// Returns half the length of the longest edge among those that start at the first corner of a triangle. The
// diagonals of the cells are among these edges.
double ball_radius(const TessellatedSurface& surface) {
  double longest_squared = 0.0;
  const auto& corners = surface.indices();
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Vector3 a = position(surface.samples(), corners[i]);
    longest_squared =
        std::max({longest_squared, (a - position(surface.samples(), corners[i + 1])).squaredNorm(),
                  (a - position(surface.samples(), corners[i + 2])).squaredNorm()});
  }
  return 0.5 * std::sqrt(longest_squared);
}

}  // namespace

// Collects the vertices that triangles use. All other vertices are trimmed away and must not be picked.
void SurfacePick::update_vertices(Sampled& sampled) {
  if (sampled.topology == sampled.surface.topology_version()) return;
  sampled.topology = sampled.surface.topology_version();
  sampled.vertices = sampled.surface.indices();
  std::sort(sampled.vertices.begin(), sampled.vertices.end());
  sampled.vertices.erase(std::unique(sampled.vertices.begin(), sampled.vertices.end()),
                         sampled.vertices.end());
}

void SurfacePick::update(const Snapshot& snapshot) {
  // A soft tool, which is the last of the bodies, must not be picked.
  surfaces_.resize(snapshot.bodies.size() - (is_soft(snapshot.tool) ? 1 : 0));
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    Sampled& sampled = surfaces_[i];
    if (snapshot.bodies[i].is_mesh()) {  // rigid tools pass through meshes
      sampled = Sampled();
      continue;
    }
    const SamplingLevel level =
        choose_sampling_level(snapshot.bodies[i].surface, picking_px_per_m, sampled.surface.level(), target);
    const bool evaluated = check_net(snapshot.bodies[i].surface).ok() &&
                           sampled.surface.update(snapshot.bodies[i].surface, level).ok();
    if (!evaluated) sampled = Sampled();
    sampled.ball_m = ball_radius(sampled.surface);
    update_vertices(sampled);
  }
}

std::optional<PickedPoint> SurfacePick::first_touch(const Ray& ray, double radius_m) const {
  double nearest = std::numeric_limits<double>::infinity();
  const Sampled* touched_surface = nullptr;
  std::uint32_t touched = 0;
  for (const Sampled& sampled : surfaces_) {
    const GridSamples<float>& samples = sampled.surface.samples();
    for (const std::uint32_t i : sampled.vertices) {
      const Vector3 point = position(samples, i);
      const auto t = first_crossing(ray, point, radius_m + sampled.ball_m);
      if (!t || *t >= nearest) continue;
      nearest = *t;
      touched_surface = &sampled;
      touched = i;
    }
  }
  if (touched_surface == nullptr) return std::nullopt;
  const Vector3 centre = ray.origin_m + nearest * ray.direction;
  const Vector3 point = find_nearest(*touched_surface, touched, centre);
  const Vector3 outward = (centre - point).normalized();
  return PickedPoint{point + radius_m * outward, outward};
}

// Returns the point nearest to `to` of the triangles at a vertex.
Vector3 SurfacePick::find_nearest(const Sampled& sampled, std::uint32_t vertex, const Vector3& to) {
  const GridSamples<float>& samples = sampled.surface.samples();
  const std::vector<std::uint32_t>& corners = sampled.surface.indices();
  Vector3 nearest = position(samples, vertex);
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    if (std::find(&corners[t], &corners[t] + 3, vertex) == &corners[t] + 3) continue;
    const Vector3 a = position(samples, corners[t]), b = position(samples, corners[t + 1]),
                  c = position(samples, corners[t + 2]);
    if ((b - a).cross(c - a).isZero(0.0)) continue;  // a triangle at a pole
    const Vector3 point = nearest_on_triangle(a, b, c, to).point;
    if ((point - to).squaredNorm() < (nearest - to).squaredNorm()) nearest = point;
  }
  return nearest;
}

namespace {

// Gap between the hovering tool and the surface.
constexpr double hover_gap_m = 0.001;

// Time until a press reaches its full depth.
constexpr double seconds_to_depth = 0.25;
// Longest time that a frame adds, so that a frame that took long does not make the hand jump.
constexpr double longest_step_s = 1.0 / 15.0;
constexpr double depth_per_notch_m = 0.001;

// Depth of a press with a tool that attaches to the body, just enough to touch the surface. It does not
// depend on the strength of the stroke.
constexpr double grip_depth_m = 2.0 * hover_gap_m;

// Returns the point where the ray meets the plane through `point_m` that faces the camera. Returns `point_m`
// if the ray is parallel to the plane.
Vector3 project_to_screen_plane(const Ray& ray, const Camera& camera, const Vector3& point_m) {
  const Vector3 back = eye_axes(camera).col(2);
  const double slope = ray.direction.dot(back);
  if (std::abs(slope) < 1e-6) return point_m;
  return ray.origin_m + ((point_m - ray.origin_m).dot(back) / slope) * ray.direction;
}

}  // namespace

HandTarget MouseHand::next_target(const HandTarget&, double elapsed_s) {
  const auto& [pointer, is_stroking, camera, viewport, pick, stroke] = frame_;
  const Ray ray = ray_through(camera, viewport, pointer.position_px);
  if (!is_stroking) must_release_ = false;
  const bool pressed = is_stroking && !must_release_;
  if (pressed && !press_) {
    press_ =
        Press{hover_m_, inward_, project_to_screen_plane(ray, camera, hover_m_), Vector3::Zero(), 0.0, 0.0};
  }
  if (!pressed) press_.reset();
  if (press_) {
    press(ray, pointer, camera, stroke, elapsed_s);
  } else {
    hover(ray, camera, *pick, stroke);
  }
  return {{target_m_, Quaternion::Identity()}, press_ ? button_main : button_hover};
}

void MouseHand::release_press() {
  must_release_ = press_.has_value();
  press_.reset();
}

void MouseHand::hover(const Ray& ray, const Camera& camera, const SurfacePick& pick,
                      const MouseStroke& stroke) {
  const auto touch = pick.first_touch(ray, stroke.radius_m);
  is_on_model_ = touch.has_value();
  if (touch) {
    hover_m_ = touch->centre_m + hover_gap_m * touch->outward;
    inward_ = -touch->outward;
    depth_point_m_ = touch->centre_m;
  } else {
    hover_m_ = project_to_screen_plane(ray, camera, depth_point_m_);
    inward_.setZero();
  }
  target_m_ = hover_m_;
}

void MouseHand::press(const Ray& ray, const Pointer& pointer, const Camera& camera, const MouseStroke& stroke,
                      double elapsed_s) {
  Press& press = *press_;
  press.seconds = std::min(press.seconds + std::min(elapsed_s, longest_step_s), seconds_to_depth);
  press.depth_m += depth_per_notch_m * pointer.wheel;
  const double fraction = press.seconds / seconds_to_depth;
  const double depth_m = stroke.grips ? grip_depth_m : hover_gap_m + stroke.strength_m;
  const Eigen::Matrix3d axes = eye_axes(camera);
  const Vector3 pointer_m = project_to_screen_plane(ray, camera, press.anchor_m);
  const Vector3 moved_m = pointer_m - std::exchange(press.pointer_m, pointer_m);
  if (pointer.alt) {
    press.depth_m += moved_m.dot(axes.col(1));
  } else {
    press.drag_m += moved_m;
  }
  target_m_ = press.anchor_m + press.drag_m + fraction * depth_m * press.inward - press.depth_m * axes.col(2);
}

}  // namespace spoonbill
