// Adjacency of triangles over their edges, subdivision of long edges and smoothed normals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// A directed side of a triangle. Side 3 t + k leads from corner k of triangle t to the triangle's next
// corner.
using MeshSide = std::uint32_t;

inline MeshSide next_side(MeshSide side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}
inline std::uint32_t side_start(const std::vector<TriangleCorners>& triangles, MeshSide side) {
  return triangles[side / 3][side % 3];
}
inline std::uint32_t side_end(const std::vector<TriangleCorners>& triangles, MeshSide side) {
  return triangles[side / 3][next_side(side) % 3];
}

// The edges of a triangle mesh, with the sides that share them. Immutable.
class MeshEdges {
 public:
  static constexpr MeshSide open = 0xffffffffU;  // the missing side of an edge that only one triangle has
  static constexpr MeshSide branching = 0xfffffffeU;  // marks a side on an edge of three or more triangles

  // The two ends of each side must differ, and all corner indices must be less than `vertices`, the number of
  // vertices.
  MeshEdges(const std::vector<TriangleCorners>& triangles, std::size_t vertices);

  // Returns the other side on the same edge. Returns `open` if the edge has one triangle, `branching` if it
  // has more than two.
  MeshSide across(MeshSide side) const { return across_[side]; }

  std::size_t open_count() const { return open_count_; }
  std::size_t branching_count() const { return branching_count_; }  // number of edges, not of sides

  // Returns the sides on the boundary. An open edge contributes its only side. If a branching edge has more
  // sides in one direction than in the other, it contributes the surplus. In a consistently oriented mesh the
  // boundary consists of closed loops.
  const std::vector<MeshSide>& boundary() const { return boundary_; }

 private:
  std::vector<MeshSide> across_;
  std::vector<MeshSide> boundary_;
  std::size_t open_count_ = 0, branching_count_ = 0;
};

// Halves edges until none is longer than `longest_m`. An edge is halved in both of its triangles, so that a
// closed mesh stays closed. Existing vertices are unchanged; new ones are appended. Each edge must have two
// triangles. Fails with too_many if the result has more than `triangle_limit` triangles.
Result<TriangleMesh> refine_edges(TriangleMesh mesh, double longest_m, std::size_t triangle_limit);

// Smoothed normals of a mesh. Slivers hardly affect them. The mesh must outlive the object. Immutable, so any
// thread may use it.
class SmoothNormals {
 public:
  explicit SmoothNormals(const TriangleMesh& mesh);

  // Returns the unit normal at a point of a triangle. `to_b` and `to_c` are the barycentric weights of the
  // second and third corner. The normal is interpolated from the corners. A corner's normal is the
  // area-weighted mean over the adjacent triangles within 30 degrees of this triangle. Returns zero if the
  // triangle has no area.
  Vector3 at(std::uint32_t triangle, double to_b, double to_c) const;

 private:
  Vector3 twice_area(std::uint32_t triangle) const;

  const TriangleMesh* mesh_;
  // The triangles at vertex v are adjacent_[starts_[v]] to adjacent_[starts_[v + 1] - 1].
  std::vector<std::uint32_t> starts_, adjacent_;
};

}  // namespace spoonbill
