#include "engine/collision/rigid/mesh_depths.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

// Depths are sampled along an edge in steps of this share of the other mesh's size, and climbed between.
constexpr double step_share = 1.0 / 32.0;
constexpr double steps_limit = 256.0;
constexpr int climbs_limit = 32;
// Of the other mesh's size: where climbing ends.
constexpr double climbed_share = 1e-9;

}  // namespace

MeshDepths::MeshDepths(const PosedMesh& mesh, const PosedMesh& other, double thickness_m)
    : mesh_(mesh),
      other_(other),
      distance_(other.clean(), thickness_m),
      around_(distance_.bounds()),
      vertices_(mesh.vertex_count()) {
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.corners(t);
    const Box box = bounding_box({mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)});
    if (box.is_near(around_, mesh.grown_at_m(a))) near_.push_back(t);
  }
  if (!mesh.has_plates() && !other.has_plates()) return;
  surface_ = std::make_unique<ShellDistance>(other.triangles().vertices_m, other.triangles().triangles,
                                             ShellDistance::Kind::sheets);
}

DeepPoint MeshDepths::at(const Vector3& point_m, double grown_m) const {
  const DistanceSample sample = distance_.at(point_m);
  return {grown_m - sample.distance_m, point_m, sample};
}

const DeepPoint& MeshDepths::at_vertex(std::uint32_t v) {
  if (!vertices_[v]) vertices_[v] = at(mesh_.vertex(v), mesh_.grown_at_m(v));
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
  const double length_m = edge.norm(), grown_m = mesh_.grown_at_m(from);
  // Depths change by no more than the way moved.
  if (!(0.5 * (start.depth_m + end.depth_m + length_m) > least_m)) return;
  const int steps =
      static_cast<int>(std::clamp(std::ceil(length_m / (step_share * around_.size())), 1.0, steps_limit));
  DeepPoint best = start, low = start;
  for (int k = 1; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    const DeepPoint high = k == steps ? end : at(start.point_m + share * edge, grown_m);
    climb(low, high, grown_m, best);
    if (k == steps || high.depth_m < 0.0) {
      if (best.depth_m > least_m) visit(best);
      best = high;
    }
    low = high;
  }
}

// To where the tangents of the depth at both ends meet, again and again: the deepest point where the depth is
// concave, as it is in a convex mesh.
void MeshDepths::climb(DeepPoint low, DeepPoint high, double grown_m, DeepPoint& best) const {
  const Vector3 between = high.point_m - low.point_m;
  const double whole_m = between.norm(), tolerance_m = climbed_share * around_.size();
  for (const DeepPoint* end : {&low, &high}) {
    if (end->depth_m > best.depth_m) best = *end;
  }
  if (!(whole_m > tolerance_m)) return;
  const Vector3 direction = between / whole_m;
  for (int k = 0; k < climbs_limit; ++k) {
    const double length_m = (high.point_m - low.point_m).norm();
    const double rise = -low.other.gradient.dot(direction), fall = -high.other.gradient.dot(direction);
    if (!(rise > 0.0 && fall < 0.0)) return;
    const double way_m = (high.depth_m - low.depth_m - fall * length_m) / (rise - fall);
    if (!(way_m > 0.0 && way_m < length_m)) return;
    if (!(low.depth_m + rise * way_m > best.depth_m + tolerance_m)) return;
    const DeepPoint middle = at(low.point_m + way_m * direction, grown_m);
    if (middle.depth_m > best.depth_m) best = middle;
    (-middle.other.gradient.dot(direction) > 0.0 ? low : high) = middle;
  }
}

std::optional<std::uint32_t> MeshDepths::plate_neighbour(const DeepPoint& deep) const {
  if (!surface_) return std::nullopt;
  const std::uint32_t nearest = surface_->nearest_triangle(deep.point_m);
  const double grown_m = deep.depth_m + deep.other.distance_m;
  const double reach_m = grown_m + other_.grown_at_m(other_.corners(nearest)[0]);
  if (!(surface_->at(deep.point_m).distance_m < reach_m)) return std::nullopt;
  return nearest;
}

}  // namespace spoonbill
