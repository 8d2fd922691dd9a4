#include "engine/collision/proximity/mesh_proximity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {
namespace {

// Box of the control net, which contains the surface.
Box net_box(const ControlNet& net) {
  Box box{net.point(0, 0), net.point(0, 0)};
  const std::vector<double>* const axes[3] = {&net.x, &net.y, &net.z};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax_element(axes[axis]->begin(), axes[axis]->end());
    box.low[axis] = *low;
    box.high[axis] = *high;
  }
  return box;
}

}  // namespace

MeshProximity::MeshProximity(const NestedGrid& surface, std::vector<int> patches, SkippedSamples skipped)
    : levels_(surface),
      tree_(surface.grid.u.knots, surface.grid.v.knots),
      patches_(std::move(patches)),
      skipped_(std::move(skipped)) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(patches_.begin(), patches_.end(), [](int patch) { return patch >= 0; }));
  const auto samples = static_cast<std::size_t>(surface.grid.rows() * surface.grid.columns());
  SPOONBILL_ASSERT(skipped_.empty() || skipped_.size() == samples);
  sampled_at_.assign(samples, 0);
  const int last_patch = patches_.empty() ? -1 : *std::max_element(patches_.begin(), patches_.end());
  const auto patch_count = static_cast<std::size_t>(last_patch + 1);
  first_vertex_.assign(patch_count + 1, 0);
  for (const int patch : patches_) ++first_vertex_[patch + 1];
  for (std::size_t p = 1; p < first_vertex_.size(); ++p) first_vertex_[p] += first_vertex_[p - 1];
  patch_vertices_.resize(patches_.size());
  std::vector<std::uint32_t> next(first_vertex_.begin(), first_vertex_.end() - 1);
  for (std::uint32_t v = 0; v < patches_.size(); ++v) patch_vertices_[next[patches_[v]]++] = v;
  patch_at_.assign(patch_count, 0);
  offered_at_.assign(patch_count, 0);
  candidate_index_.assign(patch_count, 0);
  candidates_.reserve(patch_count);
  samples_.reserve(near_point_limit);
  vertices_.reserve(near_point_limit);
  // Each step of a descent into the binary tree adds at most one node to the stack.
  pending_.reserve(64);
}

void MeshProximity::find(const Surface& surface, const DeformingMesh& mesh, double margin_m) {
  SPOONBILL_ASSERT(mesh.vertices_m().size() == patches_.size());
  SPOONBILL_ASSERT(margin_m >= 0.0);
  ++search_;
  least_gap_m_ = infinity;
  budget_ = {proximity_evaluation_limit, proximity_least_gain_m};
  overflow_ = false;
  candidates_.clear();
  samples_.clear();
  vertices_.clear();
  if (net_box(surface.net).gap(mesh.bounds()) > margin_m) return;
  if (levels_.begin(surface)) tree_.update(levels_);
  visit_elements(mesh, margin_m);
  resolve_patches(mesh, margin_m);
}

void MeshProximity::visit_elements(const DeformingMesh& mesh, double margin) {
  pending_.clear();
  pending_.push_back(tree_.root());
  while (!pending_.empty()) {
    const int index = pending_.back();
    pending_.pop_back();
    if (!tree_.box(index).is_near(mesh.bounds(), margin)) continue;
    const ElementTree::Node& node = tree_.node(index);
    if (node.is_leaf()) {
      search_element(node, tree_.box(index), mesh, margin);
    } else {
      pending_.push_back(node.right);
      pending_.push_back(node.left);
    }
  }
}

void MeshProximity::search_element(const ElementTree::Node& element, const Box& box,
                                   const DeformingMesh& mesh, double margin) {
  ++elements_;
  bool is_near = false;
  const std::vector<BoxTree::Node>& nodes = mesh.tree().nodes();
  mesh.tree().search([&](std::uint32_t index) { return nodes[index].box.is_near(box, margin); },
                     [](std::uint32_t, std::uint32_t) { return false; },
                     [&](std::uint32_t first, std::uint32_t count) {
                       if (!is_near) levels_.sample_element(element.first_u, element.first_v);
                       is_near = true;
                       for (std::uint32_t t = first; t < first + count; ++t) {
                         for (const std::uint32_t vertex : mesh.triangles()[t]) {
                           offer_vertex(element, box, vertex, mesh.vertices_m()[vertex], margin);
                         }
                       }
                     });
  if (is_near) collect_samples(element, mesh, margin);
}

// Compares a vertex with an element if the element's box is within the margin of the vertex. The first such
// vertex of a patch becomes the patch's candidate; the other vertices of the patch are skipped.
void MeshProximity::offer_vertex(const ElementTree::Node& element, const Box& box, std::uint32_t vertex,
                                 const Vector3& point, double margin) {
  const int patch = patches_[vertex];
  const bool found = patch_at_[patch] == search_;
  if (found && (offered_at_[patch] == elements_ || candidates_[candidate_index_[patch]].vertex != vertex))
    return;
  if (signed_distance(box, point) > margin) return;
  if (!found) {
    patch_at_[patch] = search_;
    candidate_index_[patch] = static_cast<int>(candidates_.size());
    candidates_.push_back({patch, vertex, 0.0, 0.0, infinity});
  }
  offered_at_[patch] = elements_;
  offer(element, point, candidates_[candidate_index_[patch]]);
}

void MeshProximity::collect_samples(const ElementTree::Node& element, const DeformingMesh& mesh,
                                    double margin) {
  const int side = levels_.step(0), columns = levels_.nested().grid.columns();
  for (int i = element.first_u * side; i <= element.end_u * side; ++i) {
    for (int j = element.first_v * side; j <= element.end_v * side; ++j) {
      const int sample = i * columns + j;
      if (sampled_at_[sample] == search_ || is_skipped(skipped_, sample)) continue;
      sampled_at_[sample] = search_;
      const auto nearest = mesh.nearest(levels_.sample(sample), margin);
      if (!nearest) continue;
      if (samples_.size() == near_point_limit) {
        overflow_ = true;
        return;
      }
      samples_.push_back({sample, *nearest});
      least_gap_m_ = std::min(least_gap_m_, nearest->gap_m);
    }
  }
}

void MeshProximity::offer(const ElementTree::Node& element, const Vector3& point, Candidate& candidate) {
  const std::vector<double>&u = levels_.nested().grid.u.parameters, &v = levels_.nested().grid.v.parameters;
  const int side = levels_.step(0);
  for (int i = element.first_u * side; i < element.end_u * side; ++i) {
    for (int j = element.first_v * side; j < element.end_v * side; ++j) {
      const NearestOnCell on = nearest_on_cell(point, levels_.corners({i, j, levels_.nested().levels}));
      if (on.distance >= candidate.distance_m) continue;
      candidate.distance_m = on.distance;
      candidate.u = u[i] + on.u * (u[i + 1] - u[i]);
      candidate.v = v[j] + on.v * (v[j + 1] - v[j]);
    }
  }
}

VertexNearSurface MeshProximity::nearest_to_vertex(std::uint32_t vertex, const Vector3& point, double u,
                                                   double v) {
  const NearestPoint nearest = nearest_point(levels_.pieces(), point, u, v, &budget_);
  const Vector3 normal = unit_normal(levels_.surface(), nearest.u, nearest.v);
  return {vertex, nearest.u, nearest.v, normal, (point - nearest.at.position_m).dot(normal)};
}

std::uint32_t MeshProximity::find_deepest_vertex(int patch, const DeformingMesh& mesh,
                                                 const Vector3& normal) const {
  std::uint32_t deepest = patch_vertices_[first_vertex_[patch]];
  double least = infinity;
  for (std::uint32_t k = first_vertex_[patch]; k < first_vertex_[patch + 1]; ++k) {
    const double height = normal.dot(mesh.vertices_m()[patch_vertices_[k]]);
    if (height >= least) continue;
    least = height;
    deepest = patch_vertices_[k];
  }
  return deepest;
}

void MeshProximity::resolve_patches(const DeformingMesh& mesh, double margin) {
  for (const Candidate& candidate : candidates_) {
    const std::vector<Vector3>& points = mesh.vertices_m();
    VertexNearSurface near =
        nearest_to_vertex(candidate.vertex, points[candidate.vertex], candidate.u, candidate.v);
    const std::uint32_t deepest = find_deepest_vertex(candidate.patch, mesh, near.normal);
    if (deepest != near.vertex) {
      const VertexNearSurface other = nearest_to_vertex(deepest, points[deepest], near.u, near.v);
      if (other.gap_m < near.gap_m) near = other;
    }
    if (near.gap_m > margin) continue;
    if (vertices_.size() == near_point_limit) {
      overflow_ = true;
      return;
    }
    vertices_.push_back(near);
    least_gap_m_ = std::min(least_gap_m_, near.gap_m);
  }
}

}  // namespace spoonbill
