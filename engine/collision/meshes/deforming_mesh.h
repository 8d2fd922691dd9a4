// A closed mesh whose vertices move, and queries for its nearest points and signed gaps.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// A point on a mesh: the corners of a triangle and their weights, whose sum is 1.
struct PointOnMesh {
  TriangleCorners vertex{};
  std::array<double, 3> weight{};
};

// Result of DeformingMesh::nearest().
struct NearestOnMesh {
  PointOnMesh on;
  // Unit outward normal at the nearest point, parallel to the line from there to the query point.
  Vector3 normal = Vector3::UnitY();
  double gap_m = 0.0;  // signed distance along the normal; negative inside the mesh
};

// Nearest point search on a closed deforming mesh. Not thread-safe. Allocates only when it is constructed or
// copied.
class DeformingMesh {
 public:
  // The mesh must be manifold: two triangles share each edge, and the triangles around each vertex form one
  // fan.
  explicit DeformingMesh(const TriangleMesh& mesh);

  const std::vector<Vector3>& vertices_m() const { return vertices_m_; }
  // Returns the vertices so that the caller can move them. The caller must call refit() before the next
  // query.
  std::vector<Vector3>& mutable_vertices_m() { return vertices_m_; }
  void refit();

  // Returns the triangles in the order of the tree's leaves.
  const std::vector<TriangleCorners>& triangles() const { return triangles_; }
  const BoxTree& tree() const { return tree_; }
  const Box& bounds() const { return tree_.nodes()[0].box; }

  // Returns the nearest point of the mesh, or nothing if it is farther than `reach_m`. The sign of the gap
  // comes from the normals of faces, edges and vertices; the normals of vertices are weighted by angle
  // (Baerentzen and Aanaes 2005).
  std::optional<NearestOnMesh> nearest(const Vector3& point_m, double reach_m) const;

 private:
  struct Nearest;
  Vector3 face_normal(std::uint32_t triangle) const;
  Vector3 vertex_normal(std::uint32_t vertex) const;
  Vector3 normal_at(const Nearest& nearest) const;

  std::vector<Vector3> vertices_m_;
  std::vector<TriangleCorners> triangles_;
  BoxTree tree_;
  std::vector<std::uint32_t> across_;  // for each side, numbered 3 t + k, the adjacent triangle
  // For each vertex, start of its corners in corners_; one more entry at the end.
  std::vector<std::uint32_t> first_corner_;
  std::vector<std::uint32_t> corners_;  // numbers 3 t + k of the corners k of triangles t, grouped by vertex
};

}  // namespace spoonbill
