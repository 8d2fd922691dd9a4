// From lattice to triangles: each vertex is embedded in the lattice's cells by fixed trilinear weights and
// follows their nodes.
#pragma once

#include <memory>
#include <vector>

#include "engine/base/containers.h"
#include "engine/collision/meshes/deforming_mesh.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// One owner, the simulation; update() allocates nothing.
class MeshMapping {
 public:
  // The lattice must be a box_lattice() about the mesh, at rest; for the mesh see DeformingMesh.
  MeshMapping(const TriangleMesh& rest, const SpringLattice& lattice);

  const DeformingMesh& current() const { return current_; }
  // In the mesh's own order; shared with whoever draws it.
  const std::shared_ptr<const std::vector<TriangleCorners>>& triangles() const { return triangles_; }

  // Moves current() to where the nodes are.
  void update(const SpringLattice& lattice);

  EmbeddedPoint vertex(std::uint32_t vertex) const;
  EmbeddedPoint at(const PointOnMesh& point) const;

  // Of each vertex, the eighth of a cell that it lies in at rest, counted through where there are any:
  // constraints that are denser than half a cell hold the same nodes twice.
  const std::vector<int>& patches() const { return patches_; }

 private:
  struct CellWeights {
    int node[8];
    float weight[8];
  };
  std::vector<Vector3> rest_m_;
  std::vector<CellWeights> embedding_;
  std::vector<int> patches_;
  std::shared_ptr<const std::vector<TriangleCorners>> triangles_;
  AlignedVector<float> node_moves_;  // x, y, z, 0 of each node
  DeformingMesh current_;
};

}  // namespace spoonbill
