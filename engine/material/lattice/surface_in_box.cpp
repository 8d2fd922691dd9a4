#include "engine/material/lattice/surface_in_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/base/text.h"
#include "engine/bspline/tube_rings.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/body_skin.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/lattice_counts.h"

namespace spoonbill {
namespace {

constexpr double least_thickness = 1e-4;

Status check_thick(const ClosedSkin& skin, double volume_m3, double size_m) {
  double area = 0.0;
  for (const TriangleCorners& t : skin.mesh.triangles) {
    const std::vector<Vector3>& at = skin.mesh.vertices_m;
    area += triangle_area(at[t[0]], at[t[1]], at[t[2]]);
  }
  const double thickness = 2.0 * volume_m3 / area;
  if (thickness >= least_thickness * size_m) return {};
  return Error{"surface: " + number_text(thickness * 1e3) + " mm thick where it is " +
               number_text(size_m * 1e3) +
               " mm long: too flat for a lattice; make it at least a ten-thousandth as thick"};
}

// Of v: the share of the body's length, of a ring that of a turn.
LinearTable shares_along(const Surface& surface) {
  if (surface.v.is_periodic()) return {{surface.v.domain_start(), surface.v.domain_end()}, {0.0, 1.0}};
  const Profile profile = sample_profile(surface);
  LinearTable shares{profile.v, profile.distance};
  for (double& distance : shares.to) distance /= profile.distance.back();
  return shares;
}

// Where on the body a point of its surface is, or any point by the nearest sample of the surface.
class Places {
 public:
  Places(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside)
      : skin_(skin),
        inside_(inside),
        along_(shares_along(surface)),
        start_(surface.u.domain_start()),
        period_(surface.u.domain_end() - start_) {}

  BodyCoordinates on_surface(double u, double v) const {
    const double turns = (u - start_) / period_;
    return {along_.at(v), turns - std::floor(turns), 0.0};
  }

  BodyCoordinates at(const Vector3& point) const {
    const TriangleCorners& corners = skin_.mesh.triangles[inside_.nearest_triangle(point)];
    const auto squared = [&](std::uint32_t corner) {
      return (skin_.mesh.vertices_m[corner] - point).squaredNorm();
    };
    const std::uint32_t nearest = *std::min_element(
        corners.begin(), corners.end(),
        [&](std::uint32_t one, std::uint32_t other) { return squared(one) < squared(other); });
    BodyCoordinates place = on_surface(skin_.u[nearest], skin_.v[nearest]);
    place.depth_m = std::max(0.0, -inside_.at(point).distance_m);
    return place;
  }

 private:
  const ClosedSkin& skin_;
  const ShellDistance& inside_;
  LinearTable along_;
  double start_, period_;
};

void place_nodes(const Places& places, LatticeMesh& box) {
  constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t n = 0; n < box.nodes.size(); ++n) {
    const bool beside = box.places[n] == NodePlace::beside_body;
    const BodyCoordinates place = beside ? BodyCoordinates{nowhere, nowhere, nowhere} : places.at(box.nodes[n]);
    box.along.push_back(place.along);
    box.turns.push_back(place.around);
    box.depth_m.push_back(place.depth_m);
  }
}

// Those of void cells too, which so are of what they lie about: they then do not stiffen anything softer.
void place_cells(const Places& places, LatticeMesh& box) {
  box.middles.resize(box.cell_count());
  for (int k = 0; k + 1 < box.count[2]; ++k) {
    for (int i = 0; i + 1 < box.count[0]; ++i) {
      for (int j = 0; j + 1 < box.count[1]; ++j) {
        box.middles[box.cell_index(i, j, k)] = places.at(trilinear(box.cell(i, j, k), 0.5, 0.5, 0.5));
      }
    }
  }
}

// Halves a triangle across its longest edge until none is longer than half a cell, and takes what it halves.
void add_between(const std::array<Vector3, 3>& corners, const Vector3& cell_m, std::vector<Vector3>& points) {
  constexpr double longest_cells = 0.5;
  std::size_t longest = 0;
  std::array<double, 3> cells{};
  for (std::size_t c = 0; c < 3; ++c) {
    cells[c] = (corners[(c + 1) % 3] - corners[c]).cwiseQuotient(cell_m).norm();
    if (cells[c] > cells[longest]) longest = c;
  }
  if (!(cells[longest] > longest_cells)) return;
  const Vector3 &from = corners[longest], &to = corners[(longest + 1) % 3],
                &across = corners[(longest + 2) % 3];
  points.emplace_back(0.5 * (from + to));
  const Vector3 middle = points.back();
  add_between({from, middle, across}, cell_m, points);
  add_between({middle, to, across}, cell_m, points);
}

// So near each other that no cell that the skin passes through is missed but where it cuts off a corner.
std::vector<Vector3> points_on(const ClosedSkin& skin, const Vector3& size,
                               const std::array<int, 3>& counts) {
  const Vector3 cell_m = size.cwiseQuotient(Vector3(counts[0] - 1, counts[1] - 1, counts[2] - 1));
  std::vector<Vector3> points = skin.mesh.vertices_m;
  const std::vector<Vector3>& at = skin.mesh.vertices_m;
  for (const TriangleCorners& t : skin.mesh.triangles) {
    add_between({at[t[0]], at[t[1]], at[t[2]]}, cell_m, points);
  }
  return points;
}

// Whether straight in from a point of the skin its far side is, which looks the other way to within half a
// right angle, before two cells are. The face beyond a sharp edge may be nearer than that, and is no far
// side.
bool is_thin_at(const ShellDistance& inside, const Vector3& skin_m, const Vector3& normal, double cell_m) {
  constexpr double far_side = -std::numbers::sqrt2 / 2.0;
  constexpr int bisections = 20;
  const auto at = [&](double cells) { return inside.at(skin_m - cells * cell_m * normal); };
  for (const double cells : {1.0, 2.0}) {
    if (at(cells).distance_m < 0.0) continue;
    double in = 0.0, out = cells;
    for (int k = 0; k < bisections; ++k) {
      const double middle = 0.5 * (in + out);
      (at(middle).distance_m < 0.0 ? in : out) = middle;
    }
    return at(out).gradient.dot(normal) < far_side;
  }
  return false;
}

bool is_slender(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside, double cell_m) {
  for (std::size_t vertex = 0; vertex < skin.u.size(); ++vertex) {
    const Vector3 normal = unit_normal(surface, skin.u[vertex], skin.v[vertex]);
    if (is_thin_at(inside, skin.mesh.vertices_m[vertex], normal, cell_m)) return true;
  }
  return false;
}

}  // namespace

Result<LatticeMesh> surface_in_box(const Surface& surface, const LatticeRequest& request) {
  const ClosedSkin skin = make_skin(surface);
  const double volume = enclosed_volume_m3(skin);
  const ShellDistance inside(skin.mesh.vertices_m, skin.mesh.triangles, ShellDistance::Kind::solid);
  const Vector3 size = inside.bounds().high - inside.bounds().low;
  if (Status thick = check_thick(skin, volume, size.maxCoeff()); !thick) return thick.error();
  const Result<std::array<int, 3>> counts = lattice_counts(request, size);
  if (!counts) return counts.error();
  Result<LatticeMesh> box =
      box_lattice(inside, volume, points_on(skin, size, counts.value()), counts.value());
  if (!box) return box;
  const Places places(surface, skin, inside);
  place_nodes(places, box.value());
  place_cells(places, box.value());
  box->skin = body_skin(surface, box.value(), [&](double u, double v) { return places.on_surface(u, v); });
  box->slender = is_slender(surface, skin, inside, box->mean_edge());
  return box;
}

}  // namespace spoonbill
