#include "engine/collision/proximity/mesh_pair_proximity.h"

#include <algorithm>
#include <cstddef>

#include "engine/base/assert.h"

namespace spoonbill {

MeshPairProximity::Side::Side(const std::vector<int>& all_patches) : patches(all_patches) {
  const int count = patches.empty() ? 0 : *std::max_element(patches.begin(), patches.end()) + 1;
  found_of_patch.assign(static_cast<std::size_t>(count), -1);
  found.reserve(found_of_patch.size());
}

void MeshPairProximity::Side::find(const DeformingMesh& mesh, const DeformingMesh& other, double margin_m) {
  SPOONBILL_ASSERT_DEBUG(mesh.vertices_m().size() == patches.size());
  for (const VertexNearMesh& near : found) {
    found_of_patch[static_cast<std::size_t>(patches[near.vertex])] = -1;
  }
  found.clear();
  const double reach_square = margin_m * margin_m;
  for (std::uint32_t v = 0; v < mesh.vertices_m().size(); ++v) {
    const Vector3& vertex = mesh.vertices_m()[v];
    if (other.bounds().squared_distance(vertex) > reach_square) continue;
    const std::optional<NearestOnMesh> nearest = other.nearest(vertex, margin_m);
    if (!nearest || nearest->gap_m > margin_m) continue;
    int& index = found_of_patch[static_cast<std::size_t>(patches[v])];
    if (index < 0) {
      index = static_cast<int>(found.size());
      found.push_back({v, *nearest});
    } else if (nearest->gap_m < found[static_cast<std::size_t>(index)].other.gap_m) {
      found[static_cast<std::size_t>(index)] = {v, *nearest};
    }
  }
}

MeshPairProximity::MeshPairProximity(const std::vector<int>& first_patches,
                                     const std::vector<int>& second_patches)
    : first_(first_patches), second_(second_patches) {}

void MeshPairProximity::find(const DeformingMesh& first, const DeformingMesh& second, double margin_m) {
  SPOONBILL_ASSERT_DEBUG(margin_m >= 0.0);
  first_.find(first, second, margin_m);
  second_.find(second, first, margin_m);
  least_gap_m_ = std::numeric_limits<double>::infinity();
  for (const std::vector<VertexNearMesh>* found : {&first_.found, &second_.found}) {
    for (const VertexNearMesh& near : *found) least_gap_m_ = std::min(least_gap_m_, near.other.gap_m);
  }
}

}  // namespace spoonbill
