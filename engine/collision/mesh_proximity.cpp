#include "engine/collision/mesh_proximity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "engine/collision/nearest_on_cell.h"
#include "engine/collision/pair_polish.h"

namespace spoonbill {
namespace {

constexpr std::size_t near_capacity = 4096;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The surface lies within it.
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

MeshProximity::MeshProximity(const NestedGrid& surface, std::vector<int> patches)
    : levels_(surface), tree_(surface.grid.u.knots, surface.grid.v.knots), patches_(std::move(patches)) {
  const auto samples = static_cast<std::size_t>(surface.grid.rows() * surface.grid.columns());
  sampled_at_.assign(samples, 0);
  offered_at_.assign(patches_.size(), 0);
  held_at_.assign(patches_.size(), 0);
  place_.assign(patches_.size(), 0);
  const int last_patch = patches_.empty() ? -1 : *std::max_element(patches_.begin(), patches_.end());
  patch_at_.assign(static_cast<std::size_t>(last_patch + 1), 0);
  deepest_.assign(static_cast<std::size_t>(last_patch + 1), 0);
  candidates_.reserve(patches_.size());
  samples_.reserve(near_capacity);
  vertices_.reserve(near_capacity);
  // A path down a tree of two children each leaves one behind at every step.
  waiting_.reserve(64);
}

void MeshProximity::find(const Surface& surface, const DeformingMesh& mesh, double margin_m) {
  ++search_;
  least_gap_m_ = infinity;
  overflow_ = false;
  candidates_.clear();
  samples_.clear();
  vertices_.clear();
  if (net_box(surface.net).gap(mesh.bounds()) > margin_m) return;
  levels_.begin(surface);
  tree_.update(levels_);
  visit_elements(mesh, margin_m);
  settle_vertices(mesh, margin_m);
}

void MeshProximity::visit_elements(const DeformingMesh& mesh, double margin) {
  waiting_.clear();
  waiting_.push_back(tree_.root());
  while (!waiting_.empty()) {
    const int index = waiting_.back();
    waiting_.pop_back();
    if (!tree_.box(index).is_near(mesh.bounds(), margin)) continue;
    const ElementTree::Node& node = tree_.node(index);
    if (node.is_leaf()) {
      take_element(node, tree_.box(index), mesh, margin);
    } else {
      waiting_.push_back(node.right);
      waiting_.push_back(node.left);
    }
  }
}

void MeshProximity::take_element(const ElementTree::Node& element, const Box& box, const DeformingMesh& mesh,
                                 double margin) {
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
                           if (offered_at_[vertex] == elements_) continue;
                           offered_at_[vertex] = elements_;
                           const Vector3& point = mesh.vertices_m()[vertex];
                           if (signed_distance(box, point) <= margin) offer(element, vertex, point, margin);
                         }
                       }
                     });
  if (is_near) take_samples(element, mesh, margin);
}

void MeshProximity::take_samples(const ElementTree::Node& element, const DeformingMesh& mesh, double margin) {
  const int side = levels_.step(0), columns = levels_.nested().grid.columns();
  for (int i = element.first_u * side; i <= element.end_u * side; ++i) {
    for (int j = element.first_v * side; j <= element.end_v * side; ++j) {
      const int sample = i * columns + j;
      if (sampled_at_[sample] == search_) continue;
      sampled_at_[sample] = search_;
      const auto nearest = mesh.nearest(levels_.sample(sample), margin);
      if (!nearest) continue;
      if (samples_.size() == near_capacity) {
        overflow_ = true;
        return;
      }
      samples_.push_back({sample, *nearest});
      least_gap_m_ = std::min(least_gap_m_, nearest->gap_m);
    }
  }
}

void MeshProximity::offer(const ElementTree::Node& element, std::uint32_t vertex, const Vector3& point,
                          double margin) {
  const Grid& grid = levels_.nested().grid;
  const int side = levels_.step(0);
  Candidate best{vertex, 0.0, 0.0, infinity, 0.0};
  for (int i = element.first_u * side; i < element.end_u * side; ++i) {
    for (int j = element.first_v * side; j < element.end_v * side; ++j) {
      const PatchCorners at = levels_.corners({i, j, levels_.nested().levels});
      const OnCell on = nearest_on_cell(point, at);
      if (on.distance >= best.distance_m) continue;
      const std::vector<double>&u = grid.u.parameters, &v = grid.v.parameters;
      const Vector3 outwards = (at[2] - at[0] + at[3] - at[1]).cross(at[1] - at[0] + at[3] - at[2]);
      const Vector3 foot =
          (1 - on.u) * ((1 - on.v) * at[0] + on.v * at[1]) + on.u * ((1 - on.v) * at[2] + on.v * at[3]);
      const double sign = (point - foot).dot(outwards) < 0.0 ? -1.0 : 1.0;
      best = {vertex, u[i] + on.u * (u[i + 1] - u[i]), v[j] + on.v * (v[j + 1] - v[j]), on.distance,
              sign * on.distance};
    }
  }
  // The surface leaves its samples' triangles by less.
  if (best.distance_m > 2.0 * margin) return;
  if (held_at_[vertex] != search_) {
    held_at_[vertex] = search_;
    place_[vertex] = static_cast<int>(candidates_.size());
    candidates_.push_back(best);
  } else if (best.distance_m < candidates_[place_[vertex]].distance_m) {
    candidates_[place_[vertex]] = best;
  }
}

void MeshProximity::settle_vertices(const DeformingMesh& mesh, double margin) {
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const int patch = patches_[candidates_[c].vertex];
    const bool first = patch_at_[patch] != search_;
    if (!first && candidates_[deepest_[patch]].gap_m <= candidates_[c].gap_m) continue;
    patch_at_[patch] = search_;
    deepest_[patch] = static_cast<int>(c);
  }
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const Candidate& candidate = candidates_[c];
    if (deepest_[patches_[candidate.vertex]] != static_cast<int>(c)) continue;
    const Vector3& point = mesh.vertices_m()[candidate.vertex];
    const NearestPoint nearest = nearest_point(levels_.pieces(), point, candidate.u, candidate.v);
    const Vector3 normal = unit_normal(levels_.surface(), nearest.u, nearest.v);
    const double gap = (point - nearest.at.position_m).dot(normal);
    if (gap > margin) continue;
    if (vertices_.size() == near_capacity) {
      overflow_ = true;
      return;
    }
    vertices_.push_back({candidate.vertex, nearest.u, nearest.v, normal, gap});
    least_gap_m_ = std::min(least_gap_m_, gap);
  }
}

}  // namespace spoonbill
