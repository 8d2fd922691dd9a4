#include "engine/collision/surfaces/closed_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/tube_rings.h"
#include "engine/collision/meshes/mesh_parts.h"

namespace spoonbill {
namespace {

// Largest outward component of a ring's points that counts as rounding error, as a fraction of the radius. A
// ring whose outward component is smaller is flat.
constexpr double flat_fraction = 1e-9;

Status check_poles(const Surface& surface) {
  const Ring first = sample_ring(surface, surface.v.domain_start());
  const Ring last = sample_ring(surface, surface.v.domain_end());
  const double size = (last.centre - first.centre).norm();
  if (!(size > 0.0)) {
    return Error(ErrorCode::degenerate,
                 "surface: the poles at both ends of v coincide; the body has no length");
  }
  if (first.perimeter > 1e-6 * size || last.perimeter > 1e-6 * size) {
    return Error(ErrorCode::inconsistent,
                 "surface: both ends of v must be poles (all control points of the edge at one position)");
  }
  return {};
}

Status check_thickness(const Surface& surface) {
  const double centre = surface.v.parameter_at(0.5);
  const Ring ring = sample_ring(surface, centre);
  double outward = 0.0, radius = 0.0;
  for (int s = 0; s < ring_samples; s += 8) {
    const double u = surface.u.parameter_at(static_cast<double>(s) / ring_samples);
    outward += unit_normal(surface, u, centre).dot(ring.points[s] - ring.centre);
    radius += (ring.points[s] - ring.centre).norm();
  }
  if (std::abs(outward) > flat_fraction * radius) return {};
  return Error(ErrorCode::degenerate,
               "surface: encloses no volume halfway along v; a body must be thick everywhere");
}

// Checks the sign of the enclosed volume. The normals of a single ring would not suffice: a ring of a hollow
// body may be on the body's inner wall, where the normals point toward the axis.
Status check_outward(const Surface& surface) {
  const double volume = enclosed_volume_m3(make_skin(surface));
  if (volume > 0.0) return {};
  if (volume < 0.0) {
    return Error(ErrorCode::inconsistent,
                 "surface: normals point inward; reverse the order of the control points in u");
  }
  return Error(ErrorCode::degenerate, "surface: encloses no volume; a body must be thick everywhere");
}

// Adds a triangle to the skin, unless it has no area, as beside a pole.
void add_triangle(ClosedSkin& skin, const TriangleCorners& corners, const std::array<double, 2>& centre) {
  const std::vector<Vector3>& at = skin.mesh.vertices_m;
  const Vector3& first = at[corners[0]];
  if (!((at[corners[1]] - first).cross(at[corners[2]] - first).squaredNorm() > 0.0)) return;
  skin.mesh.triangles.push_back(corners);
  skin.triangle_centres.push_back(centre);
}

}  // namespace

Status check_closed_tube(const Surface& surface) {
  if (!surface.u.is_periodic()) {
    return Error(ErrorCode::inconsistent, "surface: u must be periodic for a closed body");
  }
  if (surface.v.is_periodic()) {
    return Error(ErrorCode::inconsistent,
                 "surface: v must be open, with a pole at both ends, for a closed body");
  }
  if (Status poles = check_poles(surface); !poles) return poles;
  if (Status thick = check_thickness(surface); !thick) return thick;
  return check_outward(surface);
}

Status check_closed(const Surface& surface) {
  if (!surface.u.is_periodic() || !surface.v.is_periodic()) return check_closed_tube(surface);
  return check_outward(surface);
}

std::vector<double> skin_parameters(const KnotVector& knots) {
  constexpr int most_pieces = 8;
  const int elements = static_cast<int>(knots.breakpoints().size()) - 1;
  const int pieces = std::clamp(skin_samples / elements, 2, most_pieces);
  return nested_parameters(knots, pieces, 0).parameters;
}

ClosedSkin make_skin(const Surface& surface) {
  return sample_skin(surface, skin_parameters(surface.u), skin_parameters(surface.v));
}

ClosedSkin sample_skin(const Surface& surface, const std::vector<double>& u, const std::vector<double>& v) {
  SPOONBILL_ASSERT(u.size() >= 2 && v.size() >= 2);
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(u.begin(), u.end()) && std::is_sorted(v.begin(), v.end()));
  const std::size_t rows = u.size() - 1, last = v.size() - 1;
  const bool ring = surface.v.is_periodic();
  ClosedSkin skin;
  std::vector<std::uint32_t> vertices(u.size() * v.size());
  const auto vertex = [&](std::size_t i, std::size_t j) -> std::uint32_t& {
    return vertices[i * v.size() + j];
  };
  for (std::size_t i = 0; i < u.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      const bool pole = !ring && (j == 0 || j == last);
      if (i > 0 && (i == rows || pole)) {
        vertex(i, j) = vertex(0, j);
      } else if (ring && j == last) {
        vertex(i, j) = vertex(i, 0);
      } else {
        vertex(i, j) = static_cast<std::uint32_t>(skin.mesh.vertices_m.size());
        skin.mesh.vertices_m.push_back(position(surface, u[i], v[j]));
        skin.u.push_back(u[i]);
        skin.v.push_back(v[j]);
      }
    }
  }
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < last; ++j) {
      add_triangle(skin, {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)},
                   {(u[i] + 2.0 * u[i + 1]) / 3.0, (2.0 * v[j] + v[j + 1]) / 3.0});
      add_triangle(skin, {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)},
                   {(2.0 * u[i] + u[i + 1]) / 3.0, (v[j] + 2.0 * v[j + 1]) / 3.0});
    }
  }
  return skin;
}

double enclosed_volume_m3(const ClosedSkin& skin) {
  MeshPart whole;
  whole.end_vertex = static_cast<std::uint32_t>(skin.mesh.vertices_m.size());
  whole.end_triangle = static_cast<std::uint32_t>(skin.mesh.triangles.size());
  return signed_volume(skin.mesh, whole);
}

}  // namespace spoonbill
