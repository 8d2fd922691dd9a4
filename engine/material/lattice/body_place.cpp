#include "engine/material/lattice/body_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

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

// Finds how far points are from the triangles; near in turn, most triangles are passed over by their spheres.
class Hull {
 public:
  explicit Hull(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    for (const Triangle& triangle : triangles_) {
      const Vector3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
      double radius = 0.0;
      for (const Vector3& corner : triangle) radius = std::max(radius, (corner - middle).norm());
      spheres_.push_back({middle, radius});
    }
  }

  double distance(const Vector3& point) {
    double nearest = distance_to(last_, point);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const double reach = nearest + spheres_[t].radius;
      if ((spheres_[t].middle - point).squaredNorm() > reach * reach) continue;
      const double there = distance_to(t, point);
      if (!(there < nearest)) continue;
      nearest = there;
      last_ = t;
    }
    return nearest;
  }

 private:
  struct Sphere {
    Vector3 middle;
    double radius;
  };

  double distance_to(std::size_t t, const Vector3& point) const {
    const Triangle& triangle = triangles_[t];
    return (nearest_on_triangle(triangle[0], triangle[1], triangle[2], point).point - point).norm();
  }

  std::vector<Triangle> triangles_;
  std::vector<Sphere> spheres_;
  std::size_t last_ = 0;  // the nearest of the point before
};

// How far out of the block's middle line a node lies, 0 to 1, counted in nodes. A shell has no middle line.
double out_of_middle(const LatticeMesh& mesh, int node) {
  if (mesh.thin) return 1.0;
  const std::array<int, 3> at = mesh.place(node);
  const double s = 2.0 * at[0] / (mesh.count[0] - 1) - 1.0, t = 2.0 * at[1] / (mesh.count[1] - 1) - 1.0;
  return std::max(std::abs(s), std::abs(t));
}

// The faces of the block that are the body's: a closed one has none where it meets itself.
Hull hull_of(const LatticeMesh& mesh) {
  std::vector<Triangle> faces;
  for (std::size_t axis = mesh.closed ? 1 : 0; axis < 3; ++axis) add_faces(mesh, axis, faces);
  return Hull(std::move(faces));
}

// Without depths but those that the mesh has.
std::vector<BodyCoordinates> places_on_block(const LatticeMesh& mesh) {
  std::vector<BodyCoordinates> places(mesh.nodes.size());
  for (int n = 0; n < mesh.node_count(); ++n) {
    BodyCoordinates& place = places[static_cast<std::size_t>(n)];
    place.along = mesh.along.empty() ? static_cast<double>(mesh.place(n)[2]) / (mesh.count[2] - 1)
                                     : mesh.along[static_cast<std::size_t>(n)];
    if (!mesh.depth_m.empty()) place.depth_m = mesh.depth_m[static_cast<std::size_t>(n)];
    if (!mesh.turns.empty()) place.around = mesh.turns[static_cast<std::size_t>(n)];
  }
  return places;
}

const BodyCoordinates& at(const std::vector<BodyCoordinates>& nodes, int node) {
  return nodes[static_cast<std::size_t>(node)];
}

// Nodes further apart than half a turn lie about the axis; between there and three quarters, which are four
// of them about it, there is none.
constexpr double around_the_axis = 0.6;

std::array<int, 8> corners_of(const LatticeMesh& mesh, int i, int j, int k) {
  std::array<int, 8> corners{};
  for (int c = 0; c < 8; ++c) {
    corners[static_cast<std::size_t>(c)] = mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
  }
  return corners;
}

}  // namespace

std::vector<BodyCoordinates> node_places(const LatticeMesh& mesh) {
  std::vector<BodyCoordinates> places = places_on_block(mesh);
  if (!mesh.depth_m.empty()) return places;
  Hull hull = hull_of(mesh);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.place(n);
    const auto node = static_cast<std::size_t>(n);
    const bool inside = mesh.closed || (at[0] > 0 && at[0] + 1 < mesh.count[0]);
    const bool in_layers = at[1] > 0 && at[2] > 0 && at[1] + 1 < mesh.count[1] && at[2] + 1 < mesh.count[2];
    if (inside && in_layers) places[node].depth_m = hull.distance(mesh.nodes[node]);
  }
  return places;
}

BodyCoordinates mean_place(const LatticeMesh& mesh, const std::vector<BodyCoordinates>& nodes, std::span<const int> of) {
  SPOONBILL_ASSERT(!of.empty() && nodes.size() == static_cast<std::size_t>(mesh.node_count()));
  BodyCoordinates place;
  double weights = 0.0, heaviest = 0.0, from = 0.0;
  for (const int node : of) {
    const double weight = out_of_middle(mesh, node);
    place.along += at(nodes, node).along / static_cast<double>(of.size());
    weights += weight;
    if (weight <= heaviest) continue;
    heaviest = weight;
    from = at(nodes, node).around;
  }
  double sum = 0.0, low = 0.0, high = 0.0;
  for (const int node : of) {
    const double weight = out_of_middle(mesh, node), apart = at(nodes, node).around - from;
    if (!(weight > 0.0)) continue;
    const double turn = apart - std::round(apart);
    sum += weight * turn;
    low = std::min(low, turn);
    high = std::max(high, turn);
  }
  const double mean = from + sum / weights;
  if (high - low < around_the_axis) place.around = mean - std::floor(mean);
  return place;
}

std::vector<BodyCoordinates> cell_places(const LatticeMesh& mesh) {
  if (!mesh.middles.empty()) return mesh.middles;
  Hull hull = hull_of(mesh);
  const std::vector<BodyCoordinates> nodes = places_on_block(mesh);
  std::vector<BodyCoordinates> places(mesh.cell_count());
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        BodyCoordinates& place = places[mesh.cell_index(i, j, k)];
        const std::array<int, 8> corners = corners_of(mesh, i, j, k);
        place = mean_place(mesh, nodes, corners);
        place.depth_m = hull.distance(trilinear(mesh.cell(i, j, k), 0.5, 0.5, 0.5));
      }
    }
  }
  return places;
}

}  // namespace spoonbill
