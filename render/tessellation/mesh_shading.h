// The vertices and normals with which a deforming mesh is drawn: smooth where its faces nearly go on, with an
// edge where they do not. No GL.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/bspline/evaluate.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// One owner, one thread.
class MeshShading {
 public:
  // Whether it is made for these triangles.
  bool is_of(const MeshSnapshot& mesh) const { return mesh.triangles == triangles_; }

  // Finds the edges by the mesh's present shape: they stay while it deforms.
  void make(const MeshSnapshot& mesh);

  // Three a triangle, counter-clockwise seen from outside.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

  // The mesh must be the one that this was made for. Allocates nothing once the samples have their size.
  void shade(const MeshSnapshot& mesh, GridSamples<float>& samples) const;

 private:
  std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles_;  // kept: none takes its place
  std::vector<std::uint32_t> indices_;  // of each corner, into the drawn vertices
  std::vector<std::uint32_t> vertex_;   // of each drawn vertex, into the mesh's
};

}  // namespace spoonbill
