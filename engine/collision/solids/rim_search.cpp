// How a tool meets a surface where trim loops end it.
#include <span>

#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/solids/tool_bounds.h"

namespace spoonbill {
namespace {

// Of golden section: to a ten thousandth of an edge.
constexpr int narrowing_steps = 20;
constexpr double golden_share = 0.6180339887498949;

Eigen::Vector2d place_on(const TrimmedArea::Edge& edge, double share) {
  return edge.from + share * (edge.to - edge.from);
}

}  // namespace

void SurfaceCollider::offer_rims(const Surface& surface, const ToolShape& tool) {
  RimEdges nearest;
  for (const LevelCell& cell : finest_) {
    if (!is_cut(cell)) continue;
    const Patch patch = whole(cell);
    if (lower_bound(tool, patch.corners, bulge(patch), best_.distance_m) >= best_.distance_m) continue;
    offer_rim(surface, tool, cell, nearest);
  }
  narrow(surface, tool, nearest);
}

// Where each edge begins and its middle.
void SurfaceCollider::offer_rim(const Surface& surface, const ToolShape& tool, const LevelCell& cell,
                                RimEdges& nearest) {
  const std::span<const TrimmedArea::Edge> edges = trimmed_->rim(cell);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const double share : {0.0, 0.5}) {
      const Eigen::Vector2d at = place_on(edges[e], share);
      const double before = best_.distance_m;
      take_nearer(tool, at.x(), at.y(), position(surface, at.x(), at.y()));
      if (!(best_.distance_m < before)) continue;
      const bool meets_last = share == 0.0 && e > 0 && edges[e - 1].to == edges[e].from;
      nearest = {&edges[e], meets_last ? &edges[e - 1] : nullptr};
    }
  }
}

// The nearest along the edges that have come nearest, one or two that meet there.
void SurfaceCollider::narrow(const Surface& surface, const ToolShape& tool, const RimEdges& nearest) {
  for (const TrimmedArea::Edge* edge : {nearest.first, nearest.second}) {
    if (edge == nullptr) continue;
    const auto distance = [&](double share) {
      const Eigen::Vector2d at = place_on(*edge, share);
      const Vector3 point = position(surface, at.x(), at.y());
      take_nearer(tool, at.x(), at.y(), point);
      return tool.distance(point);
    };
    double low = 0.0, high = 1.0;
    double inner = 1.0 - golden_share, outer = golden_share;
    double at_inner = distance(inner), at_outer = distance(outer);
    for (int step = 0; step < narrowing_steps; ++step) {
      if (at_inner < at_outer) {
        high = outer;
        outer = inner;
        at_outer = at_inner;
        inner = high - golden_share * (high - low);
        at_inner = distance(inner);
      } else {
        low = inner;
        inner = outer;
        at_inner = at_outer;
        outer = low + golden_share * (high - low);
        at_outer = distance(outer);
      }
    }
  }
}

// Nothing is proven where a part of the cell is not there: its middle, if that is kept, and its corners,
// samples and loops, which were offered, are where Newton's method begins.
void SurfaceCollider::search_cut_cell(const Surface& surface, const ToolShape& tool, const LevelCell& cell) {
  const Patch patch = whole(cell);
  const double needed = enough();
  if (lower_bound(tool, patch.corners, bulge(patch), needed) >= needed) return;
  const double u = 0.5 * (patch.u0 + patch.u1), v = 0.5 * (patch.v0 + patch.v1);
  const double before = best_.distance_m;
  offer(tool, u, v, position(surface, u, v));
  if (best_.distance_m < before) polish(surface, tool);
}

bool SurfaceCollider::touches_cut(const Surface& surface, const ToolShape& tool, const LevelCell& cell) {
  const auto touches_at = [&](double u, double v) {
    return tool.distance_within(position(surface, u, v), 2.0 * touch_tolerance_m) <= touch_tolerance_m;
  };
  const Patch patch = whole(cell);
  if (lower_bound(tool, patch.corners, bulge(patch), 0.0) > 0.0) return false;
  for (const double u : {patch.u0, 0.5 * (patch.u0 + patch.u1), patch.u1}) {
    for (const double v : {patch.v0, 0.5 * (patch.v0 + patch.v1), patch.v1}) {
      if (trimmed_->contains(u, v) && touches_at(u, v)) return true;
    }
  }
  for (const TrimmedArea::Edge& edge : trimmed_->rim(cell)) {
    if (touches_at(edge.from.x(), edge.from.y()) || touches_at(edge.to.x(), edge.to.y())) return true;
  }
  return false;
}

}  // namespace spoonbill
