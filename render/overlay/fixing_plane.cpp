#include "render/overlay/fixing_plane.h"

#include <algorithm>
#include <cmath>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

constexpr double fixing_overhang_share = 0.45;  // of the larger side, on each side
constexpr float border_width_px = 1.4f;

struct PlaneAxes {
  Vector3 up, across;
};

PlaneAxes axes_of(const PlaneSnapshot& plane) {
  const Vector3 vertical = std::abs(plane.normal.y()) < 0.95 ? Vector3::UnitY() : Vector3::UnitX();
  const Vector3 up = (vertical - plane.normal * plane.normal.dot(vertical)).normalized();
  return {up, plane.normal.cross(up)};
}

// Along the plane's axes, from its point.
Eigen::Vector2d place_on(const PlaneAxes& axes, const Vector3& offset) {
  return {axes.up.dot(offset), axes.across.dot(offset)};
}

Box2 extent_of(const PlaneSnapshot& plane, const Box& body, const PlaneAxes& axes) {
  Box2 extent;
  for (int i = 0; i < 8 && !body.is_empty(); ++i)
    extent.include(place_on(axes, body.corner(i) - plane.point_m));
  if (extent.is_empty()) extent.include(place_on(axes, Vector3::Zero()));
  return extent;
}

Box2 extent_of(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies, const Box& body,
               const PlaneAxes& axes) {
  Box2 extent;
  for (const BodySnapshot& held : bodies) {
    const LatticeSnapshot& lattice = held.lattice;
    for (std::size_t i = 0; i < lattice.x.size(); ++i) {
      if (lattice.fixed[i] == 0) continue;
      extent.include(place_on(axes, Vector3(lattice.x[i], lattice.y[i], lattice.z[i]) - plane.point_m));
    }
  }
  return extent.is_empty() ? extent_of(plane, body, axes) : extent;
}

PlaneCorners corners_of(const PlaneSnapshot& plane, const PlaneAxes& axes, Box2 extent, double share) {
  const double overhang = share * extent.extent().maxCoeff();
  extent.low.array() -= overhang;
  extent.high.array() += overhang;
  const auto at = [&](double up, double across) {
    return Vector3(plane.point_m + up * axes.up + across * axes.across);
  };
  return {at(extent.low.x(), extent.low.y()), at(extent.high.x(), extent.low.y()),
          at(extent.high.x(), extent.high.y()), at(extent.low.x(), extent.high.y())};
}

}  // namespace

PlaneCorners fixing_plane_corners(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies,
                                  const Box& body) {
  const PlaneAxes axes = axes_of(plane);
  return corners_of(plane, axes, extent_of(plane, bodies, body, axes), fixing_overhang_share);
}

PlaneCorners corners_around(const PlaneSnapshot& plane, const Box& body, double overhang_share) {
  const PlaneAxes axes = axes_of(plane);
  return corners_of(plane, axes, extent_of(plane, body, axes), overhang_share);
}

Vector3 plane_arrow_tip(const PlaneCorners& corners, const PlaneSnapshot& plane) {
  const double length = 0.30 * (corners[2] - corners[1]).norm();
  return 0.5 * (corners[1] + corners[2]) + length * plane.normal;
}

void append_plane_border(const PlaneCorners& corners, const PlaneSnapshot& plane,
                         std::vector<OverlayLine>& lines) {
  const auto add = [&](const Vector3& a, const Vector3& b) {
    lines.push_back({a.cast<float>(), b.cast<float>(), palette::fixing_plane_border,
                     palette::fixing_plane_border, border_width_px});
  };
  for (std::size_t i = 0; i < 4; ++i) add(corners[i], corners[(i + 1) % 4]);
  const Vector3 middle_of_top = 0.5 * (corners[1] + corners[2]);
  const Vector3 side = (corners[2] - corners[1]).normalized();
  const Vector3 tip = plane_arrow_tip(corners, plane);
  const double length = (tip - middle_of_top).norm();
  add(middle_of_top, tip);
  add(tip, tip - 0.3 * length * (plane.normal + side));
  add(tip, tip - 0.3 * length * (plane.normal - side));
}

}  // namespace spoonbill
