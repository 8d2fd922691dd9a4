// A closed mesh whose vertices move: the nearest point of it as it is now, and on which side of it one is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// A point of a mesh: shares of a triangle's corners, which sum to 1.
struct PointOnMesh {
  TriangleCorners vertex{};
  std::array<double, 3> share{};
};

struct NearestOnMesh {
  PointOnMesh on;
  Vector3 normal = Vector3::UnitY();  // unit, out of the mesh, along the way between the two points
  double gap_m = 0.0;                 // along it; below zero inside
};

// One owner, one thread; allocates only when made and copied.
class DeformingMesh {
 public:
  // Every edge must have two triangles, and those at a vertex make one umbrella.
  explicit DeformingMesh(const TriangleMesh& mesh);

  const std::vector<Vector3>& vertices_m() const { return vertices_m_; }
  // To be moved, and settled before anything is asked.
  std::vector<Vector3>& moving_vertices_m() { return vertices_m_; }
  void settle();

  // In the order of the tree's leaves.
  const std::vector<TriangleCorners>& triangles() const { return triangles_; }
  const BoxTree& tree() const { return tree_; }
  const Box& bounds() const { return tree_.nodes()[0].box; }

  // None where no point of it is within `reach_m`. The side is told by the normals of faces, edges and
  // vertices, the latter weighted by angles (Baerentzen and Aanaes 2005).
  std::optional<NearestOnMesh> nearest(const Vector3& point_m, double reach_m) const;

 private:
  struct Nearest;
  Box bounding_box(std::uint32_t triangle) const;
  Vector3 face_normal(std::uint32_t triangle) const;
  Vector3 vertex_normal(std::uint32_t vertex) const;
  Vector3 normal_at(const Nearest& nearest) const;

  std::vector<Vector3> vertices_m_;
  std::vector<TriangleCorners> triangles_;
  BoxTree tree_;
  std::vector<std::uint32_t> across_;        // the triangle beyond each side
  std::vector<std::uint32_t> first_corner_;  // of each vertex, into corners_; one more at the end
  std::vector<std::uint32_t> corners_;       // 3 t + k: corner k of triangle t
};

}  // namespace spoonbill
