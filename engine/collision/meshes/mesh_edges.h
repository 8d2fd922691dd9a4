// Which sides of triangles lie on one edge.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Side 3 t + k of a mesh goes from corner k of triangle t to the next.
using MeshSide = std::uint32_t;

inline MeshSide next_side(MeshSide side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}
inline std::uint32_t start_of(const std::vector<TriangleCorners>& triangles, MeshSide side) {
  return triangles[side / 3][side % 3];
}
inline std::uint32_t end_of(const std::vector<TriangleCorners>& triangles, MeshSide side) {
  return triangles[side / 3][next_side(side) % 3];
}

class MeshEdges {
 public:
  static constexpr MeshSide open = 0xffffffffU;       // no other triangle has the edge
  static constexpr MeshSide branching = 0xfffffffeU;  // more than one other has

  // The two ends of a side must differ.
  MeshEdges(const std::vector<TriangleCorners>& triangles, std::size_t vertices);

  // The one other side on this one's edge, or one of the above.
  MeshSide across(MeshSide side) const { return across_[side]; }

  std::size_t open_count() const { return open_count_; }
  std::size_t branching_count() const { return branching_count_; }  // edges, not sides

  // Of an open edge its side; of a branching one those in the direction that more sides have, as many as are
  // more. Closed where triangles agree, for what comes to a vertex also leaves it.
  const std::vector<MeshSide>& boundary() const { return boundary_; }

 private:
  std::vector<MeshSide> across_;
  std::vector<MeshSide> boundary_;
  std::size_t open_count_ = 0, branching_count_ = 0;
};

}  // namespace spoonbill
