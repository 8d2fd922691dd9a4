#include "engine/material/lattice/surface_in_box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/bspline/unit_normal.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/meshes/shell_distance.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/closed_surface.h"
#include "engine/material/lattice/share_table.h"
#include "engine/material/lattice/tube_rings.h"
#include "engine/number_text.h"

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
ShareTable shares_along(const Surface& surface) {
  if (surface.v.is_periodic()) return {{surface.v.domain_start(), surface.v.domain_end()}, {0.0, 1.0}};
  const Profile profile = sample_profile(surface);
  ShareTable shares{profile.v, profile.distance};
  for (double& distance : shares.to) distance /= profile.distance.back();
  return shares;
}

std::size_t nearest_vertex(const std::vector<Vector3>& vertices, const Vector3& point) {
  const auto nearer = [&](const Vector3& a, const Vector3& b) {
    return (a - point).squaredNorm() < (b - point).squaredNorm();
  };
  return static_cast<std::size_t>(std::min_element(vertices.begin(), vertices.end(), nearer) -
                                  vertices.begin());
}

void place_nodes(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside,
                 LatticeMesh& box) {
  const ShareTable along = shares_along(surface);
  const double start = surface.u.domain_start(), period = surface.u.domain_end() - start;
  for (std::size_t n = 0; n < box.nodes.size(); ++n) {
    const bool beside = box.places[n] == NodePlace::beside_body;
    const std::size_t vertex = beside ? 0 : nearest_vertex(skin.mesh.vertices_m, box.nodes[n]);
    const double turns = (skin.u[vertex] - start) / period;
    box.along.push_back(along.at(skin.v[vertex]));
    box.turns.push_back(turns - std::floor(turns));
    box.depth_m.push_back(beside ? 0.0 : std::max(0.0, -inside.at(box.nodes[n]).distance_m));
  }
}

// From each vertex inwards.
bool is_slender(const Surface& surface, const ClosedSkin& skin, const ShellDistance& inside, double cell_m) {
  for (std::size_t vertex = 0; vertex < skin.u.size(); ++vertex) {
    const Vector3 inward = -cell_m * unit_normal(surface, skin.u[vertex], skin.v[vertex]);
    for (const double cells : {1.0, 2.0}) {
      if (!(inside.at(skin.mesh.vertices_m[vertex] + cells * inward).distance_m < 0.0)) return true;
    }
  }
  return false;
}

}  // namespace

Result<LatticeMesh> surface_in_box(const Surface& surface, const LatticeRequest& request) {
  const ClosedSkin skin = skin_of(surface);
  const double volume = enclosed_volume_m3(skin);
  const ShellDistance inside(skin.mesh.vertices_m, skin.mesh.triangles, ShellDistance::Kind::solid);
  const Vector3 size = inside.bounds().high - inside.bounds().low;
  if (Status thick = check_thick(skin, volume, size.maxCoeff()); !thick) return thick.error();
  const Result<std::array<int, 3>> counts = lattice_counts(request, size);
  if (!counts) return counts.error();
  Result<LatticeMesh> box = box_lattice(inside, volume, skin.mesh.vertices_m, counts.value());
  if (!box) return box;
  place_nodes(surface, skin, inside, box.value());
  box->slender = is_slender(surface, skin, inside, box->mean_edge());
  return box;
}

}  // namespace spoonbill
