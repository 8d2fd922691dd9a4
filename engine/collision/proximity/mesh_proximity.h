// Where a closed surface and a deforming mesh come near each other: samples of the surface with the mesh's
// nearest points, and vertices of the mesh with the surface's.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/collision/levels/element_tree.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/deforming_mesh.h"

namespace spoonbill {

// A sample of the surface's grid.
struct SampleNearMesh {
  int sample;
  NearestOnMesh mesh;
};

struct VertexNearSurface {
  std::uint32_t vertex;
  double u, v;         // of the surface's nearest point
  Vector3 normal;      // unit, of the surface there, outwards
  double gap_m = 0.0;  // along it; below zero, how deep the vertex is in the body
};

// One owner, one thread; allocates only when made. The grid must outlive it.
class MeshProximity {
 public:
  // `patches`: where each vertex of the mesh belongs, from 0. Vertices may be far denser than what they move:
  // of each patch only the one that is deepest, or nearest, is told, as far as the surface is flat beside it.
  MeshProximity(const NestedGrid& surface, std::vector<int> patches);
  MeshProximity(const MeshProximity&) = delete;
  MeshProximity& operator=(const MeshProximity&) = delete;

  // All that is within `margin_m`. The surface must have the grid's knots and bound a body, du x dv outwards;
  // the mesh must be the one of the patches, settled.
  void find(const Surface& surface, const DeformingMesh& mesh, double margin_m);

  // Keeps those of the points of either that `keep_sample` and `keep_vertex` keep, as they leave them.
  template <class KeepSample, class KeepVertex>
  void keep_if(const KeepSample& keep_sample, const KeepVertex& keep_vertex) {
    std::erase_if(samples_, [&](SampleNearMesh& near) { return !keep_sample(near); });
    std::erase_if(vertices_, [&](VertexNearSurface& near) { return !keep_vertex(near); });
    least_gap_m_ = std::numeric_limits<double>::infinity();
    for (const SampleNearMesh& near : samples_) least_gap_m_ = std::min(least_gap_m_, near.mesh.gap_m);
    for (const VertexNearSurface& near : vertices_) least_gap_m_ = std::min(least_gap_m_, near.gap_m);
  }

  // Of the last find().
  const std::vector<SampleNearMesh>& of_surface() const { return samples_; }
  const std::vector<VertexNearSurface>& of_mesh() const { return vertices_; }
  double least_gap_m() const { return least_gap_m_; }  // infinite where nothing is near
  // A capacity was met, and points may be missing. Remedy: fewer control points or a smaller margin.
  bool overflow() const { return overflow_; }

 private:
  // Of a patch, one vertex that is near, and the nearest point to it of the surface's samples.
  struct Candidate {
    int patch;
    std::uint32_t vertex;
    double u, v, distance_m;
  };
  void visit_elements(const DeformingMesh& mesh, double margin);
  void take_element(const ElementTree::Node& element, const Box& box, const DeformingMesh& mesh,
                    double margin);
  void take_vertex(const ElementTree::Node& element, const Box& box, std::uint32_t vertex,
                   const Vector3& point, double margin);
  void take_samples(const ElementTree::Node& element, const DeformingMesh& mesh, double margin);
  void offer(const ElementTree::Node& element, const Vector3& point, Candidate& candidate);
  void settle_patches(const DeformingMesh& mesh, double margin);
  VertexNearSurface settled(std::uint32_t vertex, const Vector3& point, double u, double v) const;
  std::uint32_t deepest_of(int patch, const DeformingMesh& mesh, const Vector3& normal) const;

  SurfaceLevels levels_;
  ElementTree tree_;
  std::vector<int> patches_;
  std::vector<std::uint32_t> first_vertex_;    // of each patch, into patch_vertices_; one more at the end
  std::vector<std::uint32_t> patch_vertices_;  // patch by patch
  std::vector<std::uint32_t> sampled_at_;      // the find() in which a sample was taken
  std::vector<std::uint32_t> patch_at_;        // the same of a patch in candidates_, at place_
  std::vector<std::uint32_t> offered_at_;  // the element to which a patch was offered last, counted through
  std::vector<int> place_;
  std::vector<Candidate> candidates_;
  std::vector<SampleNearMesh> samples_;
  std::vector<VertexNearSurface> vertices_;
  std::vector<int> waiting_;  // working memory: nodes of the tree
  std::uint32_t search_ = 0, elements_ = 0;
  double least_gap_m_ = 0.0;
  bool overflow_ = false;
};

}  // namespace spoonbill
