#include "engine/material/lattice/body_coordinates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

// Adds both halves of a quad, except halves without area, as at a pole.
void add_quad(const std::array<Vector3, 4>& corners, std::vector<Triangle>& triangles) {
  for (const Triangle& half :
       {Triangle{corners[0], corners[1], corners[2]}, Triangle{corners[0], corners[2], corners[3]}}) {
    if ((half[1] - half[0]).cross(half[2] - half[0]).squaredNorm() > 0.0) triangles.push_back(half);
  }
}

// Adds the faces at both ends of one axis of the block.
void add_faces(const LatticeMesh& mesh, std::size_t axis, std::vector<Triangle>& triangles) {
  const std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
  const auto node = [&](int end, int a, int b) {
    std::array<int, 3> grid{};
    grid[axis] = end;
    grid[first] = a;
    grid[second] = b;
    return mesh.nodes[static_cast<std::size_t>(mesh.index(grid[0], grid[1], grid[2]))];
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

// Distances of points from a set of triangles. Consecutive points should be close: bounding spheres then
// reject most triangles.
class Hull {
 public:
  explicit Hull(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    for (const Triangle& triangle : triangles_) {
      const Vector3 centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
      double radius = 0.0;
      for (const Vector3& corner : triangle) radius = std::max(radius, (corner - centre).norm());
      spheres_.push_back({centre, radius});
    }
  }

  double distance(const Vector3& point) {
    double nearest = distance_to(last_, point);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const double reach = nearest + spheres_[t].radius;
      if ((spheres_[t].centre - point).squaredNorm() > reach * reach) continue;
      const double there = distance_to(t, point);
      if (!(there < nearest)) continue;
      nearest = there;
      last_ = t;
    }
    return nearest;
  }

 private:
  struct Sphere {
    Vector3 centre;
    double radius;
  };

  double distance_to(std::size_t t, const Vector3& point) const {
    const Triangle& triangle = triangles_[t];
    return (nearest_on_triangle(triangle[0], triangle[1], triangle[2], point).point - point).norm();
  }

  std::vector<Triangle> triangles_;
  std::vector<Sphere> spheres_;
  std::size_t last_ = 0;  // index of the triangle nearest to the previous point
};

// Returns the distance of a node from the centre line of the block, measured in grid indices: 0 on the line,
// 1 on the hull. Shells have no centre line; the distance is 1.
double distance_from_centre_line(const LatticeMesh& mesh, int node) {
  if (mesh.thin) return 1.0;
  const std::array<int, 3> at = mesh.grid_index(node);
  const double s = 2.0 * at[0] / (mesh.count[0] - 1) - 1.0, t = 2.0 * at[1] / (mesh.count[1] - 1) - 1.0;
  return std::max(std::abs(s), std::abs(t));
}

// Returns the outer faces of the block. A closed block has no faces at its seam.
Hull make_hull(const LatticeMesh& mesh) {
  std::vector<Triangle> faces;
  for (std::size_t axis = mesh.closed ? 1 : 0; axis < 3; ++axis) add_faces(mesh, axis, faces);
  return Hull(std::move(faces));
}

// Returns the body coordinates of all nodes; depths are set only if the mesh stores them.
std::vector<BodyCoordinates> block_coordinates(const LatticeMesh& mesh) {
  std::vector<BodyCoordinates> coordinates(mesh.nodes.size());
  for (int n = 0; n < mesh.node_count(); ++n) {
    BodyCoordinates& location = coordinates[static_cast<std::size_t>(n)];
    location.along = mesh.along.empty() ? static_cast<double>(mesh.grid_index(n)[2]) / (mesh.count[2] - 1)
                                        : mesh.along[static_cast<std::size_t>(n)];
    if (!mesh.depth_m.empty()) location.depth_m = mesh.depth_m[static_cast<std::size_t>(n)];
    if (!mesh.turns.empty()) location.around = mesh.turns[static_cast<std::size_t>(n)];
  }
  return coordinates;
}

const BodyCoordinates& at(const std::vector<BodyCoordinates>& nodes, int node) {
  return nodes[static_cast<std::size_t>(node)];
}

// Largest angular range, in turns, of points that are taken to be on one side of the axis. Points on one side
// span at most half a turn; the corners of a face or cell around the axis span about three quarters.
constexpr double max_range_on_one_side = 0.6;

std::array<int, 8> corner_nodes(const LatticeMesh& mesh, int i, int j, int k) {
  std::array<int, 8> corners{};
  for (int c = 0; c < 8; ++c) {
    corners[static_cast<std::size_t>(c)] = mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
  }
  return corners;
}

}  // namespace

std::vector<BodyCoordinates> find_node_coordinates(const LatticeMesh& mesh) {
  std::vector<BodyCoordinates> coordinates = block_coordinates(mesh);
  if (!mesh.depth_m.empty()) return coordinates;
  Hull hull = make_hull(mesh);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.grid_index(n);
    const auto node = static_cast<std::size_t>(n);
    const bool inside = mesh.closed || (at[0] > 0 && at[0] + 1 < mesh.count[0]);
    const bool in_layers = at[1] > 0 && at[2] > 0 && at[1] + 1 < mesh.count[1] && at[2] + 1 < mesh.count[2];
    if (inside && in_layers) coordinates[node].depth_m = hull.distance(mesh.nodes[node]);
  }
  return coordinates;
}

BodyCoordinates mean_coordinates(const LatticeMesh& mesh, const std::vector<BodyCoordinates>& nodes,
                                 std::span<const int> selected) {
  SPOONBILL_ASSERT(!selected.empty() && nodes.size() == static_cast<std::size_t>(mesh.node_count()));
  BodyCoordinates location;
  double weights = 0.0, heaviest = 0.0, reference = 0.0;
  for (const int node : selected) {
    const double weight = distance_from_centre_line(mesh, node);
    location.along += at(nodes, node).along / static_cast<double>(selected.size());
    weights += weight;
    if (weight <= heaviest) continue;
    heaviest = weight;
    reference = at(nodes, node).around;
  }
  double sum = 0.0, low = 0.0, high = 0.0;
  for (const int node : selected) {
    const double weight = distance_from_centre_line(mesh, node), apart = at(nodes, node).around - reference;
    if (!(weight > 0.0)) continue;
    const double offset = apart - std::round(apart);
    sum += weight * offset;
    low = std::min(low, offset);
    high = std::max(high, offset);
  }
  const double mean = reference + sum / weights;
  if (high - low < max_range_on_one_side) location.around = mean - std::floor(mean);
  return location;
}

std::vector<BodyCoordinates> find_cell_coordinates(const LatticeMesh& mesh) {
  if (!mesh.cell_centres.empty()) return mesh.cell_centres;
  Hull hull = make_hull(mesh);
  const std::vector<BodyCoordinates> nodes = block_coordinates(mesh);
  std::vector<BodyCoordinates> coordinates(mesh.cell_count());
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        BodyCoordinates& location = coordinates[mesh.cell_index(i, j, k)];
        const std::array<int, 8> corners = corner_nodes(mesh, i, j, k);
        location = mean_coordinates(mesh, nodes, corners);
        location.depth_m = hull.distance(trilinear(mesh.cell(i, j, k), 0.5, 0.5, 0.5));
      }
    }
  }
  return coordinates;
}

namespace {

void add_side(const LatticeMesh& mesh, std::size_t axis, int end, std::vector<ShellFace>& faces) {
  const std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
  const auto node = [&](int a, int b) {
    std::array<int, 3> grid{};
    grid[axis] = end;
    grid[first] = a;
    grid[second] = b;
    return mesh.index(grid[0], grid[1], grid[2]);
  };
  for (int a = 0; a + 1 < mesh.count[first]; ++a) {
    for (int b = 0; b + 1 < mesh.count[second]; ++b) {
      const int corner = node(a, b), beside = node(a + 1, b), across = node(a + 1, b + 1),
                above = node(a, b + 1);
      faces.push_back(end > 0 ? ShellFace{corner, beside, across, above}
                              : ShellFace{corner, above, across, beside});
    }
  }
}

}  // namespace

std::vector<ShellFace> shell_faces(const LatticeMesh& mesh) {
  std::vector<ShellFace> faces;
  for (std::size_t axis = mesh.closed ? 1 : 0; axis < 3; ++axis) {
    add_side(mesh, axis, 0, faces);
    add_side(mesh, axis, mesh.count[axis] - 1, faces);
  }
  return faces;
}

std::vector<ShellFace> find_faces_in(const BodyRegion& region, const LatticeMesh& mesh,
                                     const std::vector<ShellFace>& faces,
                                     const std::vector<BodyCoordinates>& coordinates) {
  SPOONBILL_ASSERT(coordinates.size() == static_cast<std::size_t>(mesh.node_count()));
  std::vector<ShellFace> selected;
  for (const ShellFace& face : faces) {
    if (contains(region, mean_coordinates(mesh, coordinates, face))) selected.push_back(face);
  }
  return selected;
}

}  // namespace spoonbill
