#include "engine/bspline/collapsed_edges.h"

#include <algorithm>

namespace spoonbill {
namespace {

bool is_clamped_at(const KnotVector& knots, bool at_end) {
  if (knots.is_periodic()) return false;
  const std::vector<double>& all = knots.knots();
  const auto degree = static_cast<std::size_t>(knots.degree());
  return at_end ? all.back() == all[all.size() - 1 - degree] : all.front() == all[degree];
}

Vector3 point_of(const ControlNet& net, std::size_t index) {
  return {net.x[index], net.y[index], net.z[index]};
}

// Returns the largest distance of the edge's points from its first.
double extent_of_edge(const ControlNet& net, const NetEdge& edge) {
  const Vector3 first = point_of(net, edge.first);
  double farthest = 0.0;
  for (std::size_t k = 1; k < edge.count; ++k) {
    farthest = std::max(farthest, (point_of(net, edge.first + k * edge.stride) - first).norm());
  }
  return farthest;
}

}  // namespace

std::vector<NetEdge> find_collapsed_edges(const Surface& surface) {
  const auto rows = static_cast<std::size_t>(surface.net.rows),
             columns = static_cast<std::size_t>(surface.net.columns);
  const double tolerance_m = collapsed_edge_fraction * bounding_box(surface.net).size();
  std::vector<NetEdge> edges;
  for (const bool at_end : {false, true}) {
    const NetEdge of_u{at_end ? (rows - 1) * columns : 0, 1, columns};
    const NetEdge of_v{at_end ? columns - 1 : 0, columns, rows};
    if (is_clamped_at(surface.u, at_end) && extent_of_edge(surface.net, of_u) <= tolerance_m) {
      edges.push_back(of_u);
    }
    if (is_clamped_at(surface.v, at_end) && extent_of_edge(surface.net, of_v) <= tolerance_m) {
      edges.push_back(of_v);
    }
  }
  return edges;
}

bool join_edge(ControlNet& net, const NetEdge& edge) {
  if (extent_of_edge(net, edge) == 0.0) return false;
  for (std::vector<double>* axis : {&net.x, &net.y, &net.z}) {
    double sum = 0.0;
    for (std::size_t k = 0; k < edge.count; ++k) sum += (*axis)[edge.first + k * edge.stride];
    const double mean = sum / static_cast<double>(edge.count);
    for (std::size_t k = 0; k < edge.count; ++k) (*axis)[edge.first + k * edge.stride] = mean;
  }
  return true;
}

bool join_collapsed_edges(Surface& surface) {
  bool moved = false;
  for (const NetEdge& edge : find_collapsed_edges(surface)) moved = join_edge(surface.net, edge) || moved;
  return moved;
}

}  // namespace spoonbill
