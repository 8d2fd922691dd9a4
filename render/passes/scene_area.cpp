#include "render/passes/scene_area.h"

#include <algorithm>
#include <cmath>

#include "render/overlay/contact_normals.h"
#include "render/overlay/fixing_plane.h"
#include "render/overlay/force_arrow.h"
#include "render/overlay/symmetry_plane.h"

namespace spoonbill {
namespace {

// Grows with projected points; whole once a point cannot be projected.
class ScreenBounds {
 public:
  ScreenBounds(const Camera& camera, const Viewport& viewport) : camera_(camera), viewport_(viewport) {}

  void include(const Vector3& point_m) {
    const auto pixel = project(camera_, viewport_, point_m);
    if (!pixel) {
      whole_ = true;
      return;
    }
    low_ = low_.cwiseMin(*pixel);
    high_ = high_.cwiseMax(*pixel);
  }
  void include(const BoundingBox& box) {
    for (int i = 0; i < 8 && !box.empty(); ++i) include(box.corner(i));
  }
  void include_sphere(const Vector3& centre_m, double radius_m) {
    BoundingBox box;
    box.include(centre_m - Vector3::Constant(radius_m));
    box.include(centre_m + Vector3::Constant(radius_m));
    include(box);
  }

  PixelArea area(double margin_px) const {
    const double width = viewport_.width_px, height = viewport_.height_px;
    if (whole_) return {0, 0, viewport_.width_px, viewport_.height_px};
    const int x0 = static_cast<int>(std::clamp(std::floor(low_.x() - margin_px), 0.0, width));
    const int x1 = static_cast<int>(std::clamp(std::ceil(high_.x() + margin_px), 0.0, width));
    const int top = static_cast<int>(std::clamp(std::floor(low_.y() - margin_px), 0.0, height));
    const int bottom = static_cast<int>(std::clamp(std::ceil(high_.y() + margin_px), 0.0, height));
    return {x0, viewport_.height_px - bottom, std::max(0, x1 - x0), std::max(0, bottom - top)};
  }

 private:
  const Camera& camera_;
  const Viewport& viewport_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e30);
  Eigen::Vector2d high_ = Eigen::Vector2d::Constant(-1e30);
  bool whole_ = false;
};

BoundingBox net_box(const Snapshot& snapshot) {
  BoundingBox box;
  for (const SurfaceSnapshot& s : snapshot.surfaces) {
    for (std::size_t i = 0; i < s.x.size(); ++i) box.include(Vector3(s.x[i], s.y[i], s.z[i]));
  }
  return box;
}

BoundingBox lattice_box(const LatticeSnapshot& lattice) {
  BoundingBox box;
  for (std::size_t i = 0; i < lattice.x.size(); ++i) {
    box.include(Vector3(lattice.x[i], lattice.y[i], lattice.z[i]));
  }
  return box;
}

}  // namespace

PixelArea scene_area(const Snapshot& snapshot, const ViewSettings& settings, const Viewport& viewport,
                     const BoundingBox& body) {
  const Overlays& on = settings.overlays;
  ScreenBounds bounds(settings.camera, viewport);
  bounds.include(body);
  if (on.lattice || on.fixed_nodes || on.touched_nodes) bounds.include(lattice_box(snapshot.lattice));
  if (on.control_net) bounds.include(net_box(snapshot));
  if (on.tool) {
    bounds.include_sphere(snapshot.tool.proxy.position_m, snapshot.tool.radius_m);
    if (snapshot.symmetric) {
      bounds.include_sphere(snapshot.mirrored_proxy.position_m, snapshot.tool.radius_m);
    }
  }
  if (on.contact_normals) {
    for (const ContactSnapshot& contact : snapshot.contacts) {
      bounds.include_sphere(contact.point_m, contact_normal_length_m(snapshot.tool));
    }
  }
  if (const auto arrow = force_arrow(snapshot, settings)) {
    bounds.include(arrow->start_m);
    bounds.include(arrow->tip_m);
  }
  if (on.fixing_planes) {
    for (const PlaneSnapshot& plane : snapshot.planes) {
      const PlaneCorners corners = fixing_plane_corners(plane, snapshot.lattice, body);
      for (const Vector3& corner : corners) bounds.include(corner);
      bounds.include(plane_arrow_tip(corners, plane));
    }
  }
  if (on.symmetry_plane && snapshot.symmetric) {
    for (const Vector3& corner : symmetry_plane_corners(snapshot.symmetry, body)) bounds.include(corner);
  }
  constexpr double margin_px = 14.0;
  return bounds.area(margin_px * settings.interface_scale);
}

}  // namespace spoonbill
