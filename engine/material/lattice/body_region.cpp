#include "engine/material/lattice/body_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/collision/meshes/nearest_on_triangle.h"
#include "engine/number_text.h"

namespace spoonbill {
namespace {

using Triangle = std::array<Vector3, 3>;

// Both halves of the quad of four nodes; none of what has no area, as at a pole.
void add_quad(const std::array<Vector3, 4>& corners, std::vector<Triangle>& triangles) {
  for (const Triangle& half :
       {Triangle{corners[0], corners[1], corners[2]}, Triangle{corners[0], corners[2], corners[3]}}) {
    if ((half[1] - half[0]).cross(half[2] - half[0]).squaredNorm() > 0.0) triangles.push_back(half);
  }
}

// The faces at both ends of one of the block's axes.
void add_faces(const LatticeMesh& mesh, std::size_t axis, std::vector<Triangle>& triangles) {
  const std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
  const auto node = [&](int end, int a, int b) {
    std::array<int, 3> place{};
    place[axis] = end;
    place[first] = a;
    place[second] = b;
    return mesh.nodes[static_cast<std::size_t>(mesh.index(place[0], place[1], place[2]))];
  };
  for (const int end : {0, mesh.count[axis] - 1}) {
    for (int a = 0; a + 1 < mesh.count[first]; ++a) {
      for (int b = 0; b + 1 < mesh.count[second]; ++b) {
        add_quad({node(end, a, b), node(end, a + 1, b), node(end, a + 1, b + 1), node(end, a, b + 1)},
                 triangles);
      }
    }
  }
}

double nearest_distance(const std::vector<Triangle>& triangles, const Vector3& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : triangles) {
    const Vector3 there = nearest_on_triangle(triangle[0], triangle[1], triangle[2], point).point;
    nearest = std::min(nearest, (there - point).squaredNorm());
  }
  return std::sqrt(nearest);
}

Status check_shares(const char* field, const Range<double>& shares, bool may_pass_seam) {
  constexpr Range<double> whole{0.0, 1.0};
  for (const double share : {shares.low, shares.high}) {
    if (Status status = check_range(field, share, whole); !status.ok()) return status;
  }
  if (may_pass_seam ? shares.low != shares.high : shares.low <= shares.high) return {};
  return Error{std::string(field) + " is [" + number_text(shares.low) + ", " + number_text(shares.high) +
               "], must run from the lower to the higher"};
}

}  // namespace

bool contains(const BodyRegion& region, const BodyPlace& place) {
  const bool around = region.around.low <= region.around.high
                          ? region.around.contains(place.around)
                          : place.around >= region.around.low || place.around <= region.around.high;
  return around && region.along.contains(place.along) && region.depth_m.contains(place.depth_m);
}

std::vector<BodyPlace> node_places(const LatticeMesh& mesh) {
  std::vector<Triangle> hull;
  for (std::size_t axis = mesh.closed ? 1 : 0; axis < 3; ++axis) add_faces(mesh, axis, hull);
  std::vector<BodyPlace> places(mesh.nodes.size());
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.place(n);
    BodyPlace& place = places[static_cast<std::size_t>(n)];
    place.along = static_cast<double>(at[2]) / (mesh.count[2] - 1);
    if (!mesh.turns.empty()) place.around = mesh.turns[static_cast<std::size_t>(n)];
    const bool inside = mesh.closed || (at[0] > 0 && at[0] + 1 < mesh.count[0]);
    const bool in_layers = at[1] > 0 && at[2] > 0 && at[1] + 1 < mesh.count[1] && at[2] + 1 < mesh.count[2];
    if (inside && in_layers) place.depth_m = nearest_distance(hull, mesh.nodes[static_cast<std::size_t>(n)]);
  }
  return places;
}

Status check_region(const BodyRegion& region) {
  if (Status status = check_shares("along", region.along, false); !status.ok()) return status;
  if (Status status = check_shares("around", region.around, true); !status.ok()) return status;
  if (region.depth_m.low >= 0.0 && region.depth_m.low <= region.depth_m.high) return {};
  return Error{"depth_mm is [" + number_text(region.depth_m.low * 1e3) + ", " +
               number_text(region.depth_m.high * 1e3) + "], must run from at least 0 to more"};
}

}  // namespace spoonbill
