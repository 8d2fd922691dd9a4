// Normals of the surface that a mesh stands for: even over its facets, and other than those of its slivers.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// One owner. The mesh must outlive it; any thread.
class SmoothNormals {
 public:
  explicit SmoothNormals(const TriangleMesh& mesh);

  // Unit, at a place in the triangle, from a on the way to b and to c: between those of its corners, each the
  // mean, by area, of the triangles there that turn from this one by less than 30 degrees. Zero where the
  // triangle has no area.
  Vector3 at(std::uint32_t triangle, double to_b, double to_c) const;

 private:
  Vector3 twice_area(std::uint32_t triangle) const;

  const TriangleMesh* mesh_;
  // Triangles at a vertex: around_[starts_[vertex]] to around_[starts_[vertex + 1]].
  std::vector<std::uint32_t> starts_, around_;
};

}  // namespace spoonbill
