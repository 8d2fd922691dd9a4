// Mapping from a lattice to a triangle mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/containers.h"
#include "engine/collision/meshes/deforming_mesh.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Mapping to a mesh whose vertices are embedded in a box lattice or in the frame of a rigid body.
// Owned by the simulation. update() and place() allocate nothing.
class MeshMapping {
 public:
  // `lattice` is a box_lattice() or a rigid_frame() about the mesh, at rest. DeformingMesh states what the
  // mesh must satisfy.
  MeshMapping(const TriangleMesh& rest, const SpringLattice& lattice)
      : MeshMapping(rest, rest.triangles, lattice) {}
  // `drawn` are the triangles to draw, of vertices of `rest`: if `rest` is a mesh with edges that were
  // halved, those of the mesh before, which look smoother.
  MeshMapping(const TriangleMesh& rest, const std::vector<TriangleCorners>& drawn,
              const SpringLattice& lattice);

  const DeformingMesh& current() const { return current_; }
  // Triangles to draw, in the order of the mesh, shared with snapshots. current() has the triangles to touch.
  const std::shared_ptr<const std::vector<TriangleCorners>>& triangles() const { return triangles_; }

  // Vertices at rest, m.
  const std::vector<Vector3>& rest_m() const { return rest_m_; }

  // Moves current() with the nodes.
  void update(const SpringLattice& lattice);
  // Puts the rest shape at a pose. Call this instead of update() for a rigid body.
  void place(const Pose& pose);

  // Returns the mapping whose rest shape is the present one. `lattice` is at rest there.
  MeshMapping rebased(const SpringLattice& lattice) const;

  EmbeddedPoint vertex(std::uint32_t vertex) const;
  EmbeddedPoint at(const PointOnMesh& point) const;

  // Returns the patch number of each vertex. A patch consists of the vertices in one octant of a lattice cell
  // at rest. Patches are numbered without gaps. Each patch gets one contact at most, because contacts denser
  // than half a cell would act on the same nodes twice. Every vertex of a rigid body is a patch of its own:
  // if the chosen vertex changed from tick to tick, soft bodies would not come to rest on it.
  const std::vector<int>& patches() const { return patches_; }

 private:
  struct CellWeights {
    int node[8];
    float weight[8];
  };
  void embed(const SpringLattice& lattice);

  std::vector<Vector3> rest_m_;
  std::vector<CellWeights> embedding_;
  std::vector<int> patches_;
  std::shared_ptr<const std::vector<TriangleCorners>> triangles_;
  AlignedVector<float> node_moves_;  // displacements of the nodes: x, y, z and 0 for each
  DeformingMesh current_;
};

}  // namespace spoonbill
