#include <algorithm>
#include <cmath>

#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

// Margin on each side: a fraction of the longer side of the rectangle, but no more than one of the body's
// size, so that the plane stays in the picture.
constexpr double fixing_overhang_fraction = 0.3, most_overhang_of_body = 0.06;
// Fixed nodes within this distance of a plane count as its section of the body, in mean edges along the
// lattice's coarsest direction.
constexpr double section_edges = 1.5;
constexpr float border_width_px = 1.4f;

struct PlaneAxes {
  Vector3 up, across;
};

PlaneAxes compute_axes(const PlaneSnapshot& plane) {
  const Vector3 vertical = std::abs(plane.normal.y()) < 0.95 ? Vector3::UnitY() : Vector3::UnitX();
  const Vector3 up = (vertical - plane.normal * plane.normal.dot(vertical)).normalized();
  return {up, plane.normal.cross(up)};
}

// Returns the coordinates of an offset along the axes of the plane.
Eigen::Vector2d project_on(const PlaneAxes& axes, const Vector3& offset) {
  return {axes.up.dot(offset), axes.across.dot(offset)};
}

Box2 compute_extent(const PlaneSnapshot& plane, const Box& body, const PlaneAxes& axes) {
  Box2 extent;
  for (int i = 0; i < 8 && !body.is_empty(); ++i)
    extent.include(project_on(axes, body.corner(i) - plane.point_m));
  if (extent.is_empty()) extent.include(project_on(axes, Vector3::Zero()));
  return extent;
}

Box2 compute_extent(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies, const Box& body,
                    const PlaneAxes& axes) {
  Box2 extent;
  for (const BodySnapshot& each : bodies) {
    const LatticeSnapshot& lattice = each.lattice;
    const auto edges_m = mean_edges_m(lattice);
    const double reach_m = section_edges * *std::max_element(edges_m.begin(), edges_m.end());
    for (std::size_t i = 0; i < lattice.x.size(); ++i) {
      const Vector3 offset = Vector3(lattice.x[i], lattice.y[i], lattice.z[i]) - plane.point_m;
      if (lattice.fixed[i] == 0 || std::abs(offset.dot(plane.normal)) > reach_m) continue;
      extent.include(project_on(axes, offset));
    }
  }
  return extent.is_empty() ? compute_extent(plane, body, axes) : extent;
}

PlaneCorners make_corners(const PlaneSnapshot& plane, const PlaneAxes& axes, Box2 extent, double overhang) {
  extent.low.array() -= overhang;
  extent.high.array() += overhang;
  const auto at = [&](double up, double across) {
    return Vector3(plane.point_m + up * axes.up + across * axes.across);
  };
  return {at(extent.low.x(), extent.low.y()), at(extent.high.x(), extent.low.y()),
          at(extent.high.x(), extent.high.y()), at(extent.low.x(), extent.high.y())};
}

constexpr double symmetry_overhang_fraction = 0.12;
constexpr float symmetry_width_px = 1.4f;
constexpr int dashes_along_longest_side = 24;
// Extent of the dash and of the dot within one period of the line, as fractions of the period.
constexpr double dash_fraction = 0.55;
constexpr double dot_start = 0.72, dot_end = 0.83;

}  // namespace

PlaneCorners fixing_plane_corners(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies,
                                  const Box& body) {
  const PlaneAxes axes = compute_axes(plane);
  const Box2 extent = compute_extent(plane, bodies, body, axes);
  double overhang = fixing_overhang_fraction * extent.extent().maxCoeff();
  if (!body.is_empty()) overhang = std::min(overhang, most_overhang_of_body * body.size());
  return make_corners(plane, axes, extent, overhang);
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
  const Vector3 top_centre = 0.5 * (corners[1] + corners[2]);
  const Vector3 side = (corners[2] - corners[1]).normalized();
  const Vector3 tip = plane_arrow_tip(corners, plane);
  const double length = (tip - top_centre).norm();
  add(top_centre, tip);
  add(tip, tip - 0.3 * length * (plane.normal + side));
  add(tip, tip - 0.3 * length * (plane.normal - side));
}

PlaneCorners symmetry_plane_corners(const PlaneSnapshot& plane, const Box& body) {
  const PlaneAxes axes = compute_axes(plane);
  const Box2 extent = compute_extent(plane, body, axes);
  return make_corners(plane, axes, extent, symmetry_overhang_fraction * extent.extent().maxCoeff());
}

void append_symmetry_plane(const PlaneCorners& corners, std::vector<OverlayLine>& lines) {
  const double longest = std::max((corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm());
  if (!(longest > 0.0)) return;
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const Vector3& start = corners[side];
    const Vector3 along = corners[(side + 1) % corners.size()] - start;
    const int dashes =
        std::max(1, static_cast<int>(std::lround(dashes_along_longest_side * along.norm() / longest)));
    const auto add = [&](double from, double to) {
      const Vector3 a = start + from / dashes * along, b = start + to / dashes * along;
      lines.push_back({a.cast<float>(), b.cast<float>(), palette::symmetry_plane, palette::symmetry_plane,
                       symmetry_width_px});
    };
    for (int dash = 0; dash < dashes; ++dash) {
      add(dash, dash + dash_fraction);
      add(dash + dot_start, dash + dot_end);
    }
  }
}

}  // namespace spoonbill
