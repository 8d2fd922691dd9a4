#include "engine/collision/rigid/mesh_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/containers.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/nearest_on_triangle.h"
#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/rigid/mesh_depths.h"
#include "engine/collision/rigid/posed_mesh.h"

namespace spoonbill {
namespace {

constexpr std::size_t crossings_limit = 4'000'000;

// Two parts, one of each mesh, and the nearest points of their surfaces.
struct Gap {
  double gap_m = std::numeric_limits<double>::infinity();  // negative where plates overlap
  std::size_t first_part = 0, second_part = 0;
  Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();
};

void take_nearer(const PosedMesh& first, const PosedMesh& second, std::size_t i, std::size_t j, Gap& least) {
  const double grown_m = first.grown_m(i) + second.grown_m(j);
  const auto found = first.rigid(i).nearest(second.rigid(j), least.gap_m + grown_m);
  if (!found || !(found->distance_m - grown_m < least.gap_m)) return;
  const Vector3 direction = (found->second_m - found->first_m).stableNormalized();
  least = {found->distance_m - grown_m, i, j, found->first_m + first.grown_m(i) * direction,
           found->second_m - second.grown_m(j) * direction};
}

Gap find_gap(const PosedMesh& first, const PosedMesh& second) {
  Gap least;
  const BodyTree parts(first.boxes()), others(second.boxes());
  parts.find_nearest(others, [&](std::size_t i, std::size_t j) {
    take_nearer(first, second, i, j, least);
    return least.gap_m;
  });
  return least;
}

// Whether the box about all of the mesh holds a part of the other, as it does where the part is inside.
bool may_contain(const PosedMesh& mesh, const PosedMesh& other) {
  Box around = mesh.boxes().front();
  for (const Box& part : mesh.boxes()) around = joined(around, part);
  return std::any_of(other.boxes().begin(), other.boxes().end(),
                     [&](const Box& part) { return around.holds(part); });
}

// The regions in which two meshes are in each other. What hangs together in one: vertices of either mesh that
// are inside and in one triangle, and pairs of triangles that cross, with the vertices inside of both and
// with pairs of a neighbour and the same other triangle.
class ContactSearch {
 public:
  ContactSearch(const PosedMesh& first, const PosedMesh& second, double thickness_m)
      : meshes_{&first, &second},
        depths_{MeshDepths(first, second, thickness_m), MeshDepths(second, first, thickness_m)} {}

  void find(const Gap& gap, MeshPairResult& result) {
    const bool surfaces_meet = gap.gap_m <= touch_tolerance_m;
    if (surfaces_meet) result.complete = find_crossings();
    for (int s = 0; s < 2; ++s) find_plates_crossing(s);
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    join_regions();
    for (int s = 0; s < 2; ++s) find_deepest(s);
    take_contacts(result);
    result.touching = surfaces_meet || !result.contacts.empty();
    result.contained = result.touching && !surfaces_meet;
    if (surfaces_meet && result.contacts.empty()) result.contacts.push_back(contact_at(gap));
  }

 private:
  using Pair = std::array<std::uint32_t, 2>;  // a triangle of each mesh

  // The deepest point of a region, and which mesh it is of.
  struct Deepest {
    DeepPoint at;
    int side = 0;
  };

  // Items of regions: the vertices of the first mesh, those of the second, the pairs.
  std::size_t vertex_item(int s, std::uint32_t v) const {
    return s == 0 ? v : meshes_[0]->vertex_count() + v;
  }
  std::size_t pair_item(std::size_t pair) const {
    return meshes_[0]->vertex_count() + meshes_[1]->vertex_count() + pair;
  }

  // False where there are too many.
  bool find_crossings() {
    const BodyTree parts(meshes_[0]->boxes()), others(meshes_[1]->boxes());
    for (const auto& [i, j] : parts.near_pairs(others)) {
      const std::size_t most = crossings_limit - pairs_.size();
      const auto crossings = meshes_[0]->rigid(i).find_crossings(meshes_[1]->rigid(j), most);
      const std::uint32_t first = meshes_[0]->parts()[i].first_triangle,
                          second = meshes_[1]->parts()[j].first_triangle;
      for (const auto& [a, b] : crossings) pairs_.push_back({first + a, second + b});
      if (crossings.size() >= most) return false;
    }
    return true;
  }

  // Plates cross what they reach, beside their sheets.
  void find_plates_crossing(int s) {
    if (!meshes_[0]->has_plates() && !meshes_[1]->has_plates()) return;
    MeshDepths& depths = depths_[s];
    for (const std::uint32_t t : depths.near()) {
      const TriangleCorners& corners = meshes_[s]->corners(t);
      const auto take_if_near = [&](const DeepPoint& deep) {
        const auto other = depths.plate_neighbour(deep);
        if (other) pairs_.push_back(s == 0 ? Pair{t, *other} : Pair{*other, t});
      };
      for (int k = 0; k < 3; ++k) {
        if (depths.is_inside(corners[k])) take_if_near(depths.at_vertex(corners[k]));
        depths.visit_edge(corners[k], corners[(k + 1) % 3], touch_tolerance_m, take_if_near);
      }
    }
  }

  void join_regions() {
    const std::size_t items = pair_item(pairs_.size());
    regions_ = DisjointSets(items);
    deepest_.assign(items, {});
    for (int s = 0; s < 2; ++s) {
      for (const std::uint32_t t : depths_[s].near()) join_inside(s, t, std::nullopt);
    }
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
      for (int s = 0; s < 2; ++s) join_inside(s, pairs_[pair][s], pair_item(pair));
    }
    for (int s = 0; s < 2; ++s) join_neighbours(s);
  }

  void join_inside(int s, std::uint32_t t, std::optional<std::size_t> item) {
    for (const std::uint32_t v : meshes_[s]->corners(t)) {
      if (!depths_[s].is_inside(v)) continue;
      if (item) regions_.join(*item, vertex_item(s, v));
      item = vertex_item(s, v);
    }
  }

  // Pairs of one triangle of the other mesh with triangles of this one that have a common vertex.
  void join_neighbours(int s) {
    std::vector<std::size_t> order(pairs_.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return pairs_[a][1 - s] < pairs_[b][1 - s]; });
    std::unordered_map<std::uint32_t, std::size_t> pair_at;  // each vertex
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Pair& pair = pairs_[order[k]];
      if (k > 0 && pairs_[order[k - 1]][1 - s] != pair[1 - s]) pair_at.clear();
      for (const std::uint32_t v : meshes_[s]->corners(pair[s])) {
        const auto [found, added] = pair_at.try_emplace(v, order[k]);
        if (!added) regions_.join(pair_item(found->second), pair_item(order[k]));
      }
    }
  }

  void offer(std::size_t item, const DeepPoint& deep, int s) {
    Deepest& deepest = deepest_[regions_.find(item)];
    if (deep.depth_m > deepest.at.depth_m) deepest = {deep, s};
  }

  void find_deepest(int s) {
    MeshDepths& depths = depths_[s];
    for (const std::uint32_t t : depths.near()) {
      for (const std::uint32_t v : meshes_[s]->corners(t)) {
        if (depths.is_inside(v)) offer(vertex_item(s, v), depths.at_vertex(v), s);
      }
    }
    for (const std::uint32_t t : depths.near()) {
      const TriangleCorners& corners = meshes_[s]->corners(t);
      for (int k = 0; k < 3; ++k) {
        std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
        if (!depths.is_inside(from)) std::swap(from, to);
        if (!depths.is_inside(from)) continue;
        const std::size_t item = vertex_item(s, from);
        const double least_m = std::max(deepest_[regions_.find(item)].at.depth_m, 0.0);
        depths.visit_edge(from, to, least_m, [&](const DeepPoint& deep) { offer(item, deep, s); });
      }
    }
    for (std::size_t first = 0, end = 0; first < pairs_.size(); first = end) {
      // The pairs of the first mesh's triangles are in their order.
      for (end = first + 1; s == 0 && end < pairs_.size() && pairs_[end][0] == pairs_[first][0];) ++end;
      find_deepest_between(s, first, end);
    }
  }

  // On the edges, with no end inside, of a triangle in these pairs.
  void find_deepest_between(int s, std::size_t first, std::size_t end) {
    const TriangleCorners& corners = meshes_[s]->corners(pairs_[first][s]);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
      if (depths_[s].is_inside(from) || depths_[s].is_inside(to)) continue;
      depths_[s].visit_edge(from, to, 0.0, [&](const DeepPoint& deep) {
        std::size_t nearest = first;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t pair = first; pair < end; ++pair) {
          const auto& [a, b, c] = meshes_[1 - s]->corners(pairs_[pair][1 - s]);
          const PosedMesh& other = *meshes_[1 - s];
          const double apart =
              (nearest_on_triangle(other.vertex(a), other.vertex(b), other.vertex(c), deep.point_m).point -
               deep.point_m)
                  .squaredNorm();
          if (apart < least) {
            least = apart;
            nearest = pair;
          }
        }
        offer(pair_item(nearest), deep, s);
      });
    }
  }

  void take_contacts(MeshPairResult& result) {
    std::vector<bool> crosses(deepest_.size(), false);
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) crosses[regions_.find(pair_item(pair))] = true;
    for (std::size_t item = 0; item < deepest_.size(); ++item) {
      const Deepest& deepest = deepest_[item];
      if (!(deepest.at.depth_m > touch_tolerance_m)) continue;
      const auto way_out = crosses[item] ? std::nullopt : contact_of_inner(item);
      result.contacts.push_back(way_out ? *way_out : contact_of(deepest));
    }
    std::stable_sort(
        result.contacts.begin(), result.contacts.end(),
        [](const MeshPairContact& one, const MeshPairContact& other) { return one.depth_m > other.depth_m; });
  }

  static MeshPairContact contact_of(const Deepest& deepest) {
    const DeepPoint& at = deepest.at;
    const Vector3& gradient = at.other.gradient;
    const double grown_m = at.depth_m + at.other.distance_m;
    MeshPairContact contact{at.point_m - grown_m * gradient, at.point_m - at.other.distance_m * gradient,
                            gradient, at.depth_m};
    if (deepest.side == 0) return contact;
    std::swap(contact.first_m, contact.second_m);
    contact.normal = -gradient;
    return contact;
  }

  // Of a region that is a whole part inside the other mesh; it starts at a vertex.
  std::optional<MeshPairContact> contact_of_inner(std::size_t item) {
    const int s = item < meshes_[0]->vertex_count() ? 0 : 1;
    const auto vertex = static_cast<std::uint32_t>(item - vertex_item(s, 0));
    const std::uint32_t p = meshes_[s]->part_of_vertex(vertex);
    const MeshPart& part = meshes_[s]->parts()[p];
    for (std::uint32_t v = part.first_vertex; v < part.end_vertex; ++v) {
      if (!depths_[s].is_inside(v)) return std::nullopt;
    }
    Gap gap;
    for (std::size_t q = 0; q < meshes_[1 - s]->parts().size(); ++q) {
      if (meshes_[s]->boxes()[p].gap(meshes_[1 - s]->boxes()[q]) >= gap.gap_m) continue;
      take_nearer(*meshes_[0], *meshes_[1], s == 0 ? p : q, s == 0 ? q : p, gap);
    }
    if (!(gap.gap_m > touch_tolerance_m)) return std::nullopt;
    const Vector3 direction = (gap.second_m - gap.first_m).normalized();
    const double length_m = std::min(meshes_[0]->length_along(gap.first_part, direction),
                                     meshes_[1]->length_along(gap.second_part, direction));
    return MeshPairContact{gap.first_m, gap.second_m, direction, gap.gap_m + length_m};
  }

  // Of meshes that touch no deeper than the tolerance.
  MeshPairContact contact_at(const Gap& gap) const {
    const Vector3 apart = gap.gap_m > 0.0 ? gap.first_m - gap.second_m : gap.second_m - gap.first_m;
    const bool has_direction = apart.norm() > 1e-3 * touch_tolerance_m;
    const Vector3 normal = has_direction ? apart.normalized() : depths_[0].outward_of_other(gap.second_m);
    return {gap.first_m, gap.second_m, normal, std::max(-gap.gap_m, 0.0)};
  }

  std::array<const PosedMesh*, 2> meshes_;
  std::array<MeshDepths, 2> depths_;  // of each in the other
  std::vector<Pair> pairs_;           // that cross, in ascending order
  DisjointSets regions_{0};
  std::vector<Deepest> deepest_;  // of each region, at the lowest of its items
};

}  // namespace

MeshPairResult collide_meshes(const CleanMesh& first, const CleanMesh& second, const Pose& second_pose,
                              double thickness_m) {
  PosedMesh one(first, Pose(), thickness_m), other(second, second_pose, thickness_m);
  const RigidScale scale = scale_for(one.triangles(), other.triangles());
  one.make_rigid(scale);
  other.make_rigid(scale);
  const Gap gap = find_gap(one, other);
  MeshPairResult result;
  if (gap.gap_m <= touch_tolerance_m || may_contain(one, other) || may_contain(other, one)) {
    ContactSearch(one, other, thickness_m).find(gap, result);
  }
  if (result.touching) return result;
  result.distance_m = gap.gap_m;
  result.nearest_first_m = gap.first_m;
  result.nearest_second_m = gap.second_m;
  return result;
}

}  // namespace spoonbill
