// Close pairs between a closed surface and a deforming mesh: samples of the surface with the nearest points
// of the mesh, and vertices of the mesh with the nearest points of the surface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/deforming_mesh.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// A sample of the surface's grid and the nearest point of the mesh.
struct SampleNearMesh {
  int sample;
  NearestOnMesh mesh;
};

// A vertex of the mesh and the nearest point of the surface.
struct VertexNearSurface {
  std::uint32_t vertex;
  double u, v;         // parameters of the nearest point of the surface
  Vector3 normal;      // unit outward normal of the surface at the nearest point
  double gap_m = 0.0;  // distance along the normal; negative if the vertex is inside the body
};

// Proximity search of a surface and a mesh. Not thread-safe. Allocates only on construction. The grid must
// outlive the search.
class MeshProximity {
 public:
  // `patches` assigns each vertex of the mesh to a patch, a group of vertices, numbered from 0. Vertices may
  // be much denser than the nodes of the spring lattice that moves them. Each patch therefore reports only
  // one vertex, its nearest or deepest. To select this vertex, the surface is treated as flat near the patch.
  // `skipped` are samples of the surface.
  MeshProximity(const NestedGrid& surface, std::vector<int> patches, SkippedSamples skipped = {});
  MeshProximity(const MeshProximity&) = delete;
  MeshProximity& operator=(const MeshProximity&) = delete;

  // Finds all points within `margin_m`. The surface must have the knots of the grid that was passed to the
  // constructor, and it must bound a body, with du x dv pointing outward. The mesh must have one vertex for
  // each entry of the constructor's `patches`, and its boxes must be up to date (refit()).
  void find(const Surface& surface, const DeformingMesh& mesh, double margin_m);

  // Removes the samples for which `keep_sample` returns false, and the vertices for which `keep_vertex`
  // returns false. Both functions may modify the point.
  template <class KeepSample, class KeepVertex>
  void keep_if(const KeepSample& keep_sample, const KeepVertex& keep_vertex) {
    std::erase_if(samples_, [&](SampleNearMesh& near) { return !keep_sample(near); });
    std::erase_if(vertices_, [&](VertexNearSurface& near) { return !keep_vertex(near); });
    least_gap_m_ = std::numeric_limits<double>::infinity();
    for (const SampleNearMesh& near : samples_) least_gap_m_ = std::min(least_gap_m_, near.mesh.gap_m);
    for (const VertexNearSurface& near : vertices_) least_gap_m_ = std::min(least_gap_m_, near.gap_m);
  }

  // Returns the samples of the surface near the mesh that the last find() found.
  const std::vector<SampleNearMesh>& surface_samples() const { return samples_; }
  // Returns the vertices of the mesh near the surface that the last find() found.
  const std::vector<VertexNearSurface>& mesh_vertices() const { return vertices_; }
  double least_gap_m() const { return least_gap_m_; }  // infinite if the last find() found nothing near
  // Returns true if a capacity was exceeded, so that points may be missing. Fewer control points or a smaller
  // margin help.
  bool overflow() const { return overflow_ || budget_.is_spent(); }
  // Returns the number of surface points that the last find() evaluated for vertices.
  int evaluations() const { return proximity_evaluation_limit - budget_.evaluations_left; }

 private:
  // A near vertex of a patch of vertices, and the point nearest to it on the triangles between the surface's
  // samples.
  struct Candidate {
    int patch;
    std::uint32_t vertex;
    double u, v, distance_m;
  };
  void visit_elements(const DeformingMesh& mesh, double margin);
  void search_element(const ElementTree::Node& element, const Box& box, const DeformingMesh& mesh,
                      double margin);
  void offer_vertex(const ElementTree::Node& element, const Box& box, std::uint32_t vertex,
                    const Vector3& point, double margin);
  void collect_samples(const ElementTree::Node& element, const DeformingMesh& mesh, double margin);
  void offer(const ElementTree::Node& element, const Vector3& point, Candidate& candidate);
  void resolve_patches(const DeformingMesh& mesh, double margin);
  VertexNearSurface nearest_to_vertex(std::uint32_t vertex, const Vector3& point, double u, double v);
  std::uint32_t find_deepest_vertex(int patch, const DeformingMesh& mesh, const Vector3& normal) const;

  SurfaceLevels levels_;
  ElementTree tree_;
  std::vector<int> patches_;
  SkippedSamples skipped_;
  // For each patch, start of its vertices in patch_vertices_; one more entry at the end.
  std::vector<std::uint32_t> first_vertex_;
  std::vector<std::uint32_t> patch_vertices_;  // vertex indices, by patch
  std::vector<std::uint32_t> sampled_at_;      // number of the find() call that last visited each sample
  // For each patch, the number of the last find() call in which it had a candidate. In this call, the
  // candidate is candidates_[candidate_index_[patch]].
  std::vector<std::uint32_t> patch_at_;
  // For each patch, the serial number of the last element that was compared with its candidate. The numbering
  // continues from one find() call to the next.
  std::vector<std::uint32_t> offered_at_;
  std::vector<int> candidate_index_;
  std::vector<Candidate> candidates_;
  std::vector<SampleNearMesh> samples_;
  std::vector<VertexNearSurface> vertices_;
  std::vector<int> pending_;  // working memory: stack of tree nodes
  std::uint32_t search_ = 0, elements_ = 0;
  double least_gap_m_ = 0.0;
  PolishBudget budget_{0};  // number of surface points that the current search may still evaluate
  bool overflow_ = false;
};

}  // namespace spoonbill
