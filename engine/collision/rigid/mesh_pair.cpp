#include "engine/collision/rigid/mesh_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/containers.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/rigid/rigid_mesh.h"

namespace spoonbill {

namespace {

// A point on a triangle of one mesh, and its depth inside the other mesh.
struct DeepPoint {
  // Depth to which the mesh's surface reaches into the other mesh at this point; negative outside. The
  // surface of a plate is half the plate's thickness from its triangles.
  double depth_m = -std::numeric_limits<double>::infinity();
  Vector3 point_m = Vector3::Zero();
  DistanceSample other;  // signed distance from the point to the other mesh
};

// Depths of one mesh in another, evaluated on demand. Not thread-safe. The meshes must outlive the object.
class MeshDepths {
 public:
  MeshDepths(const PosedMesh& mesh, const PosedMesh& other, double thickness_m);

  // Returns the triangles whose boxes are near the other mesh. They include all triangles that reach into the
  // other mesh.
  const std::vector<std::uint32_t>& near() const { return near_; }

  const DeepPoint& at_vertex(std::uint32_t v);
  bool is_inside(std::uint32_t v);

  // Divides the edge into the stretches that are inside the other mesh, and calls `visit` with the deepest
  // point of each stretch if that point is deeper than `least_m` (not negative). Exact up to rounding if the
  // other mesh is convex. Otherwise, stretches shorter than a step between samples (step_fraction) may be
  // missed.
  void visit_edge(std::uint32_t from, std::uint32_t to, double least_m,
                  const std::function<void(const DeepPoint&)>& visit);

  // Returns the triangle of the other mesh that is nearest to the point, if its distance from the point is
  // less than the sum of the half thicknesses of both plates (0 for a solid). Otherwise returns nothing.
  std::optional<std::uint32_t> find_plate_neighbour(const DeepPoint& deep) const;

  // Returns the outward direction of the other mesh at a point of its surface.
  Vector3 outward_of_other(const Vector3& point_m) const { return distance_.at(point_m).gradient; }

 private:
  DeepPoint at(const Vector3& point_m, double half_thickness_m) const;
  void climb(DeepPoint low, DeepPoint high, double half_thickness_m, DeepPoint& best) const;

  const PosedMesh& mesh_;
  const PosedMesh& other_;
  MeshDistance distance_;  // signed distance of the other mesh
  Box other_box_;          // box of the other mesh
  std::vector<std::uint32_t> near_;
  std::vector<std::optional<DeepPoint>> vertices_;  // one for each vertex, evaluated on demand
  // Triangles of the other mesh; null unless one of the meshes has plates.
  std::unique_ptr<ShellDistance> surface_;
};

// Step between depth samples along an edge, as a fraction of the other mesh's size. An edge has at most
// `steps_limit` steps.
constexpr double step_fraction = 1.0 / 32.0;
constexpr double steps_limit = 256.0;
constexpr int climbs_limit = 32;
// Convergence tolerance of the ascent, as a fraction of the other mesh's size.
constexpr double climb_tolerance = 1e-9;

MeshDepths::MeshDepths(const PosedMesh& mesh, const PosedMesh& other, double thickness_m)
    : mesh_(mesh),
      other_(other),
      distance_(other.clean(), thickness_m),
      other_box_(distance_.bounds()),
      vertices_(mesh.vertex_count()) {
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.corners(t);
    const Box box = bounding_box({mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)});
    if (box.is_near(other_box_, mesh.half_thickness_at_m(a))) near_.push_back(t);
  }
  if (!mesh.has_plates() && !other.has_plates()) return;
  surface_ = std::make_unique<ShellDistance>(other.triangles().vertices_m, other.triangles().triangles,
                                             ShellDistance::Kind::sheets);
}

DeepPoint MeshDepths::at(const Vector3& point_m, double half_thickness_m) const {
  const DistanceSample sample = distance_.at(point_m);
  return {half_thickness_m - sample.distance_m, point_m, sample};
}

const DeepPoint& MeshDepths::at_vertex(std::uint32_t v) {
  if (!vertices_[v]) vertices_[v] = at(mesh_.vertex(v), mesh_.half_thickness_at_m(v));
  return *vertices_[v];
}

bool MeshDepths::is_inside(std::uint32_t v) {
  return at_vertex(v).depth_m > touch_tolerance_m;
}

void MeshDepths::visit_edge(std::uint32_t from, std::uint32_t to, double least_m,
                            const std::function<void(const DeepPoint&)>& visit) {
  SPOONBILL_ASSERT(least_m >= 0.0);
  const DeepPoint start = at_vertex(from), end = at_vertex(to);
  const Vector3 edge = end.point_m - start.point_m;
  const double length_m = edge.norm(), half_thickness_m = mesh_.half_thickness_at_m(from);
  // Along an edge, the depth changes by at most the distance moved, which bounds the depth between the ends.
  if (!(0.5 * (start.depth_m + end.depth_m + length_m) > least_m)) return;
  const int steps = static_cast<int>(
      std::clamp(std::ceil(length_m / (step_fraction * other_box_.size())), 1.0, steps_limit));
  DeepPoint best = start, low = start;
  for (int k = 1; k <= steps; ++k) {
    const double fraction = static_cast<double>(k) / steps;
    const DeepPoint high = k == steps ? end : at(start.point_m + fraction * edge, half_thickness_m);
    climb(low, high, half_thickness_m, best);
    if (k == steps || high.depth_m < 0.0) {
      if (best.depth_m > least_m) visit(best);
      best = high;
    }
    low = high;
  }
}

// Replaces `best` if a point between `low` and `high` is deeper. Moves repeatedly to the intersection of the
// depth's tangents at both ends of the interval. Finds the maximum if the depth is concave, as in a convex
// mesh.
void MeshDepths::climb(DeepPoint low, DeepPoint high, double half_thickness_m, DeepPoint& best) const {
  const Vector3 between = high.point_m - low.point_m;
  const double whole_m = between.norm(), tolerance_m = climb_tolerance * other_box_.size();
  for (const DeepPoint* end : {&low, &high}) {
    if (end->depth_m > best.depth_m) best = *end;
  }
  if (!(whole_m > tolerance_m)) return;
  const Vector3 direction = between / whole_m;
  for (int k = 0; k < climbs_limit; ++k) {
    const double length_m = (high.point_m - low.point_m).norm();
    const double rise = -low.other.gradient.dot(direction), fall = -high.other.gradient.dot(direction);
    if (!(rise > 0.0 && fall < 0.0)) return;
    const double offset_m = (high.depth_m - low.depth_m - fall * length_m) / (rise - fall);
    if (!(offset_m > 0.0 && offset_m < length_m)) return;
    if (!(low.depth_m + rise * offset_m > best.depth_m + tolerance_m)) return;
    const DeepPoint candidate = at(low.point_m + offset_m * direction, half_thickness_m);
    if (candidate.depth_m > best.depth_m) best = candidate;
    (-candidate.other.gradient.dot(direction) > 0.0 ? low : high) = candidate;
  }
}

std::optional<std::uint32_t> MeshDepths::find_plate_neighbour(const DeepPoint& deep) const {
  if (!surface_) return std::nullopt;
  const std::uint32_t nearest = surface_->nearest_triangle(deep.point_m);
  const double half_thickness_m = deep.depth_m + deep.other.distance_m;
  const double reach_m = half_thickness_m + other_.half_thickness_at_m(other_.corners(nearest)[0]);
  if (!(surface_->at(deep.point_m).distance_m < reach_m)) return std::nullopt;
  return nearest;
}

}  // namespace

namespace {

constexpr std::size_t crossings_limit = 4'000'000;

// Nearest points of two parts, one part of each mesh.
struct Gap {
  double gap_m = std::numeric_limits<double>::infinity();  // distance; negative if plates overlap
  std::size_t first_part = 0, second_part = 0;
  Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();
};

void update_nearest_triangles(const PosedMesh& first, const PosedMesh& second, std::size_t i, std::size_t j,
                              Gap& least) {
  const double half_thickness_m = first.half_thickness_m(i) + second.half_thickness_m(j);
  const auto found = first.rigid(i).nearest(second.rigid(j), least.gap_m + half_thickness_m);
  if (!found || !(found->distance_m - half_thickness_m < least.gap_m)) return;
  const Vector3 direction = (found->second_m - found->first_m).stableNormalized();
  least = {found->distance_m - half_thickness_m, i, j, found->first_m + first.half_thickness_m(i) * direction,
           found->second_m - second.half_thickness_m(j) * direction};
}

Gap find_gap(const PosedMesh& first, const PosedMesh& second) {
  Gap least;
  const BodyTree parts(first.boxes()), others(second.boxes());
  parts.find_nearest(others, [&](std::size_t i, std::size_t j) {
    update_nearest_triangles(first, second, i, j, least);
    return least.gap_m;
  });
  return least;
}

// Returns true if the box of the whole mesh contains the box of a part of the other mesh, a necessary
// condition for containment.
bool may_contain(const PosedMesh& mesh, const PosedMesh& other) {
  Box around = mesh.boxes().front();
  for (const Box& part : mesh.boxes()) around = joined(around, part);
  return std::any_of(other.boxes().begin(), other.boxes().end(),
                     [&](const Box& part) { return around.holds(part); });
}

// Search for the regions in which two meshes overlap. The vertices of a triangle that are inside the other
// mesh are all in the same region. A pair of crossing triangles is in the same region as the inside vertices
// of both triangles. Two pairs are in the same region if they have one triangle in common and their other
// triangles share a vertex.
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
    collect_contacts(result);
    result.touching = surfaces_meet || !result.contacts.empty();
    result.contained = result.touching && !surfaces_meet;
    if (surfaces_meet && result.contacts.empty()) result.contacts.push_back(make_touch_contact(gap));
  }

 private:
  using Pair = std::array<std::uint32_t, 2>;  // one triangle of each mesh

  // The deepest point of a region and the mesh that it belongs to.
  struct Deepest {
    DeepPoint at;
    int side = 0;
  };

  // Returns the number of a vertex among the items of regions_. The items are the vertices of the first mesh,
  // then the vertices of the second mesh, then the pairs of triangles.
  std::size_t vertex_item(int s, std::uint32_t v) const {
    return s == 0 ? v : meshes_[0]->vertex_count() + v;
  }
  std::size_t pair_item(std::size_t pair) const {
    return meshes_[0]->vertex_count() + meshes_[1]->vertex_count() + pair;
  }

  // Finds the pairs of crossing triangles. Returns false if their number reached the limit.
  bool find_crossings() {
    const BodyTree parts(meshes_[0]->boxes()), others(meshes_[1]->boxes());
    for (const auto& [i, j] : parts.near_pairs(others)) {
      const std::size_t limit = crossings_limit - pairs_.size();
      const auto crossings = meshes_[0]->rigid(i).find_crossings(meshes_[1]->rigid(j), limit);
      const std::uint32_t first = meshes_[0]->parts()[i].first_triangle,
                          second = meshes_[1]->parts()[j].first_triangle;
      for (const auto& [a, b] : crossings) pairs_.push_back({first + a, second + b});
      if (crossings.size() >= limit) return false;
    }
    return true;
  }

  // Adds pairs of triangles that meet only because of the thickness of plates.
  void find_plates_crossing(int s) {
    if (!meshes_[0]->has_plates() && !meshes_[1]->has_plates()) return;
    MeshDepths& depths = depths_[s];
    for (const std::uint32_t t : depths.near()) {
      const TriangleCorners& corners = meshes_[s]->corners(t);
      const auto add_if_near = [&](const DeepPoint& deep) {
        const auto other = depths.find_plate_neighbour(deep);
        if (other) pairs_.push_back(s == 0 ? Pair{t, *other} : Pair{*other, t});
      };
      for (int k = 0; k < 3; ++k) {
        if (depths.is_inside(corners[k])) add_if_near(depths.at_vertex(corners[k]));
        depths.visit_edge(corners[k], corners[(k + 1) % 3], touch_tolerance_m, add_if_near);
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

  // Joins the regions of two pairs if their triangles of mesh `s` have a common vertex and their triangle of
  // the other mesh is the same.
  void join_neighbours(int s) {
    std::vector<std::size_t> order(pairs_.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return pairs_[a][1 - s] < pairs_[b][1 - s]; });
    // For each vertex of mesh `s`, the first pair whose triangle has this vertex.
    std::unordered_map<std::uint32_t, std::size_t> pair_at;
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
      // Pairs with the same triangle of the first mesh are consecutive. For the second mesh, each pair is
      // treated by itself.
      for (end = first + 1; s == 0 && end < pairs_.size() && pairs_[end][0] == pairs_[first][0];) ++end;
      find_deepest_between(s, first, end);
    }
  }

  // Finds the deepest points on the edges of a triangle of mesh `s`, and updates the deepest points of the
  // regions that contain them. Skips edges that have an end inside the other mesh. All pairs from `first` to
  // `end` have this triangle.
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
          const double separation =
              (nearest_on_triangle(other.vertex(a), other.vertex(b), other.vertex(c), deep.point_m).point -
               deep.point_m)
                  .squaredNorm();
          if (separation < least) {
            least = separation;
            nearest = pair;
          }
        }
        offer(pair_item(nearest), deep, s);
      });
    }
  }

  void collect_contacts(MeshPairResult& result) {
    std::vector<bool> crosses(deepest_.size(), false);
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) crosses[regions_.find(pair_item(pair))] = true;
    for (std::size_t item = 0; item < deepest_.size(); ++item) {
      const Deepest& deepest = deepest_[item];
      if (!(deepest.at.depth_m > touch_tolerance_m)) continue;
      const auto containment = crosses[item] ? std::nullopt : make_containment_contact(item);
      result.contacts.push_back(containment ? *containment : make_contact(deepest));
    }
    std::stable_sort(
        result.contacts.begin(), result.contacts.end(),
        [](const MeshPairContact& one, const MeshPairContact& other) { return one.depth_m > other.depth_m; });
  }

  static MeshPairContact make_contact(const Deepest& deepest) {
    const DeepPoint& at = deepest.at;
    const Vector3& gradient = at.other.gradient;
    const double half_thickness_m = at.depth_m + at.other.distance_m;
    MeshPairContact contact{at.point_m - half_thickness_m * gradient,
                            at.point_m - at.other.distance_m * gradient, gradient, at.depth_m};
    if (deepest.side == 0) return contact;
    std::swap(contact.first_m, contact.second_m);
    contact.normal = -gradient;
    return contact;
  }

  // Makes the contact of a region that is a whole part of one mesh inside the other mesh. `item` is one of
  // the region's vertices. Returns nothing if the region is not a whole part.
  std::optional<MeshPairContact> make_containment_contact(std::size_t item) {
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
      update_nearest_triangles(*meshes_[0], *meshes_[1], s == 0 ? p : q, s == 0 ? q : p, gap);
    }
    if (!(gap.gap_m > touch_tolerance_m)) return std::nullopt;
    const Vector3 direction = (gap.second_m - gap.first_m).normalized();
    const double length_m = std::min(meshes_[0]->length_along(gap.first_part, direction),
                                     meshes_[1]->length_along(gap.second_part, direction));
    return MeshPairContact{gap.first_m, gap.second_m, direction, gap.gap_m + length_m};
  }

  // Makes the contact of meshes that only touch, no deeper than the tolerance.
  MeshPairContact make_touch_contact(const Gap& gap) const {
    const Vector3 separation = gap.gap_m > 0.0 ? gap.first_m - gap.second_m : gap.second_m - gap.first_m;
    const bool has_direction = separation.norm() > 1e-3 * touch_tolerance_m;
    const Vector3 normal =
        has_direction ? separation.normalized() : depths_[0].outward_of_other(gap.second_m);
    return {gap.first_m, gap.second_m, normal, std::max(-gap.gap_m, 0.0)};
  }

  std::array<const PosedMesh*, 2> meshes_;
  std::array<MeshDepths, 2> depths_;  // depths of each mesh in the other
  std::vector<Pair> pairs_;           // pairs of triangles that meet, in ascending order
  DisjointSets regions_{0};
  std::vector<Deepest> deepest_;  // deepest point of each region, at the index of its lowest item
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
