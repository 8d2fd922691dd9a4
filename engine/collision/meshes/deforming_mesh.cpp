#include "engine/collision/meshes/deforming_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

// Smallest distance of a point from its nearest point on the mesh, in metres, at which the direction between
// the two is reliable.
constexpr double on_surface_m = 1e-12;

Box box_of_corners(const std::vector<Vector3>& vertices, const TriangleCorners& corners) {
  return bounding_box(Triangle{vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]});
}

std::vector<Box> make_boxes(const TriangleMesh& mesh) {
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (const TriangleCorners& corners : mesh.triangles)
    boxes.push_back(box_of_corners(mesh.vertices_m, corners));
  return boxes;
}

// Returns the arc tangent for x from 0 to 1, accurate to 2e-8 (Abramowitz and Stegun 1964, 4.4.49). The C
// library's result differs in its last bits between processors, which would change the simulation's state.
double arc_tangent(double x) {
  constexpr double term[] = {-0.3333314528, 0.1999355085, -0.1420889944, 0.1065626393,
                             -0.0752896400, 0.0429096138, -0.0161657367, 0.0028662257};
  const double square = x * x;
  double sum = 0.0;
  for (int t = 7; t >= 0; --t) sum = (sum + term[t]) * square;
  return x * (1.0 + sum);
}

// Returns the angle between two unit vectors, 0 to pi. The tangent of half the angle is |a - b| / |a + b|.
double corner_angle(const Vector3& a, const Vector3& b) {
  constexpr double quarter_turn = 1.57079632679489662;
  const double across = (a - b).norm(), along = (a + b).norm();
  if (across <= along) return along > 0.0 ? 2.0 * arc_tangent(across / along) : 0.0;
  return 2.0 * (quarter_turn - arc_tangent(along / across));
}

std::array<double, 3> barycentric_weights(const Vector3& a, const Vector3& b, const Vector3& c,
                                          const Vector3& point) {
  const Vector3 normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  if (!(square > 0.0)) return {1.0, 0.0, 0.0};
  const double weight_a = std::clamp(normal.dot((b - point).cross(c - point)) / square, 0.0, 1.0);
  const double weight_b = std::clamp(normal.dot((c - point).cross(a - point)) / square, 0.0, 1.0 - weight_a);
  return {weight_a, weight_b, 1.0 - weight_a - weight_b};
}

}  // namespace

struct DeformingMesh::Nearest {
  double squared;
  std::uint32_t triangle = 0;
  NearestOnTriangle on{};
};

DeformingMesh::DeformingMesh(const TriangleMesh& mesh)
    : vertices_m_(mesh.vertices_m), tree_(make_boxes(mesh), triangle_leaf_size) {
  SPOONBILL_ASSERT(!mesh.triangles.empty());
  triangles_.reserve(mesh.triangles.size());
  for (const std::uint32_t index : tree_.order()) triangles_.push_back(mesh.triangles[index]);
  const MeshEdges edges(triangles_, vertices_m_.size());
  across_.resize(3 * triangles_.size());
  for (MeshSide side = 0; side < across_.size(); ++side) {
    SPOONBILL_ASSERT(edges.across(side) < across_.size());  // the mesh is closed and does not branch
    across_[side] = edges.across(side) / 3;
  }
  first_corner_.assign(vertices_m_.size() + 1, 0);
  for (const TriangleCorners& corners : triangles_) {
    for (const std::uint32_t vertex : corners) ++first_corner_[vertex + 1];
  }
  for (std::size_t v = 1; v < first_corner_.size(); ++v) first_corner_[v] += first_corner_[v - 1];
  corners_.resize(3 * triangles_.size());
  std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
  for (std::uint32_t corner = 0; corner < corners_.size(); ++corner) {
    corners_[next[triangles_[corner / 3][corner % 3]]++] = corner;
  }
}

void DeformingMesh::refit() {
  tree_.refit([&](std::uint32_t position) { return box_of_corners(vertices_m_, triangles_[position]); });
}

Vector3 DeformingMesh::face_normal(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles_[triangle];
  return (vertices_m_[b] - vertices_m_[a]).cross(vertices_m_[c] - vertices_m_[a]).normalized();
}

Vector3 DeformingMesh::vertex_normal(std::uint32_t vertex) const {
  Vector3 sum = Vector3::Zero();
  for (std::uint32_t c = first_corner_[vertex]; c < first_corner_[vertex + 1]; ++c) {
    const std::uint32_t triangle = corners_[c] / 3, k = corners_[c] % 3;
    const Vector3& corner = vertices_m_[vertex];
    const Vector3 to_next = (vertices_m_[triangles_[triangle][(k + 1) % 3]] - corner).normalized();
    const Vector3 to_previous = (vertices_m_[triangles_[triangle][(k + 2) % 3]] - corner).normalized();
    sum += corner_angle(to_next, to_previous) * face_normal(triangle);
  }
  return sum;
}

Vector3 DeformingMesh::normal_at(const Nearest& nearest) const {
  using On = NearestOnTriangle::On;
  if (nearest.on.on == On::corner) return vertex_normal(triangles_[nearest.triangle][nearest.on.which]);
  Vector3 face = face_normal(nearest.triangle);
  if (nearest.on.on == On::face) return face;
  return face + face_normal(across_[3 * nearest.triangle + nearest.on.which]);
}

std::optional<NearestOnMesh> DeformingMesh::nearest(const Vector3& point_m, double reach_m) const {
  SPOONBILL_ASSERT_DEBUG(reach_m >= 0.0);
  Nearest best{reach_m * reach_m};
  bool found = false;
  const std::vector<BoxTree::Node>& nodes = tree_.nodes();
  tree_.search(
      [&](std::uint32_t index) { return nodes[index].box.squared_distance(point_m) < best.squared; },
      [&](std::uint32_t left, std::uint32_t right) {
        return nodes[right].box.squared_distance(point_m) < nodes[left].box.squared_distance(point_m);
      },
      [&](std::uint32_t first, std::uint32_t count) {
        for (std::uint32_t t = first; t < first + count; ++t) {
          const auto& [a, b, c] = triangles_[t];
          const auto on = nearest_on_triangle(vertices_m_[a], vertices_m_[b], vertices_m_[c], point_m);
          const double squared = (on.point - point_m).squaredNorm();
          if (!(squared < best.squared)) continue;
          best = {squared, t, on};
          found = true;
        }
      });
  if (!found) return std::nullopt;
  const TriangleCorners& corners = triangles_[best.triangle];
  NearestOnMesh result;
  result.on = {corners, barycentric_weights(vertices_m_[corners[0]], vertices_m_[corners[1]],
                                            vertices_m_[corners[2]], best.on.point)};
  const Vector3 normal = normal_at(best), offset = point_m - best.on.point;
  const double distance = std::sqrt(best.squared), side = offset.dot(normal) < 0.0 ? -1.0 : 1.0;
  result.gap_m = side * distance;
  const bool use_offset = distance > on_surface_m && best.on.on != NearestOnTriangle::On::face;
  result.normal = use_offset ? Vector3(side / distance * offset) : Vector3(normal.normalized());
  return result;
}

}  // namespace spoonbill
