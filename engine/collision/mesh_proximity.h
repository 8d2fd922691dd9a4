// Where a closed surface and a deforming mesh come near each other: samples of the surface with the mesh's
// nearest points, and vertices of the mesh with the surface's.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/deforming_mesh.h"
#include "engine/collision/element_tree.h"
#include "engine/collision/surface_levels.h"

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
  // of each patch only the one that is deepest, or nearest, is told.
  MeshProximity(const NestedGrid& surface, std::vector<int> patches);
  MeshProximity(const MeshProximity&) = delete;
  MeshProximity& operator=(const MeshProximity&) = delete;

  // All that is within `margin_m`. The surface must have the grid's knots and bound a body, du x dv outwards;
  // the mesh must be the one of the patches, settled.
  void find(const Surface& surface, const DeformingMesh& mesh, double margin_m);

  // Of the last find().
  const std::vector<SampleNearMesh>& of_surface() const { return samples_; }
  const std::vector<VertexNearSurface>& of_mesh() const { return vertices_; }
  double least_gap_m() const { return least_gap_m_; }  // infinite where nothing is near
  // A capacity was met, and points may be missing. Remedy: fewer control points or a smaller margin.
  bool overflow() const { return overflow_; }

 private:
  // The nearest point of the sampled surface to a vertex, before it is sought on the surface itself.
  struct Candidate {
    std::uint32_t vertex;
    double u, v, distance_m, gap_m;
  };
  void visit_elements(const DeformingMesh& mesh, double margin);
  void take_element(const ElementTree::Node& element, const Box& box, const DeformingMesh& mesh,
                    double margin);
  void take_samples(const ElementTree::Node& element, const DeformingMesh& mesh, double margin);
  void offer(const ElementTree::Node& element, std::uint32_t vertex, const Vector3& point, double margin);
  void settle_vertices(const DeformingMesh& mesh, double margin);

  SurfaceLevels levels_;
  ElementTree tree_;
  std::vector<int> patches_;
  std::vector<std::uint32_t> offered_at_;  // the element to which a vertex was offered last, counted through
  std::vector<std::uint32_t> sampled_at_;  // the find() in which a sample was taken
  std::vector<std::uint32_t> held_at_;     // the same of a vertex in candidates_, at place_
  std::vector<int> place_;
  std::vector<std::uint32_t> patch_at_;  // the same of a patch's deepest, at deepest_
  std::vector<int> deepest_;
  std::vector<Candidate> candidates_;
  std::vector<SampleNearMesh> samples_;
  std::vector<VertexNearSurface> vertices_;
  std::vector<int> waiting_;  // working memory: nodes of the tree
  std::uint32_t search_ = 0, elements_ = 0;
  double least_gap_m_ = 0.0;
  bool overflow_ = false;
};

}  // namespace spoonbill
