// Close pairs between two closed meshes that move: vertices of each with the nearest points of the other.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/collision/meshes/deforming_mesh.h"

namespace spoonbill {

// A vertex of one mesh and the nearest point of the other.
struct VertexNearMesh {
  std::uint32_t vertex = 0;
  NearestOnMesh other;
};

// Proximity search of two meshes. Finds no contact of two edges, so the edges of both should be short. Not
// thread-safe. Allocates only on construction.
class MeshPairProximity {
 public:
  // The patches assign each vertex of a mesh to a group of vertices, numbered from 0. A patch reports only
  // one vertex, its nearest or deepest.
  MeshPairProximity(const std::vector<int>& first_patches, const std::vector<int>& second_patches);

  // Finds all points within `margin_m`. The boxes of both meshes must be up to date (DeformingMesh::refit()).
  void find(const DeformingMesh& first, const DeformingMesh& second, double margin_m);

  // Returns the vertices of each mesh near the other that the last find() found.
  const std::vector<VertexNearMesh>& first_vertices() const { return first_.found; }
  const std::vector<VertexNearMesh>& second_vertices() const { return second_.found; }
  double least_gap_m() const { return least_gap_m_; }  // infinite if the last find() found nothing near
  static constexpr bool overflow() { return false; }   // every patch has a place

 private:
  struct Side {
    explicit Side(const std::vector<int>& patches);
    void find(const DeformingMesh& mesh, const DeformingMesh& other, double margin_m);

    std::vector<int> patches;
    std::vector<int> found_of_patch;  // index in `found`, or -1
    std::vector<VertexNearMesh> found;
  };

  Side first_, second_;
  double least_gap_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace spoonbill
