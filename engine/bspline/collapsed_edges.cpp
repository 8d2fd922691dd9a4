#include "engine/bspline/collapsed_edges.h"

#include <algorithm>

namespace spoonbill {
namespace {

Vector3 point_of(const ControlNet& net, std::size_t index) {
  return {net.x[index], net.y[index], net.z[index]};
}

// Returns the largest distance of the edge's control points from the first of them.
double extent_of_edge(const ControlNet& net, const NetEdge& edge) {
  const Vector3 first = point_of(net, edge.first);
  double farthest = 0.0;
  for (std::size_t k = 1; k < edge.count; ++k) {
    farthest = std::max(farthest, (point_of(net, edge.first + k * edge.stride) - first).norm());
  }
  return farthest;
}

}  // namespace

NetEdge find_edge(const ControlNet& net, bool of_u, bool at_end) {
  const auto rows = static_cast<std::size_t>(net.rows), columns = static_cast<std::size_t>(net.columns);
  if (of_u) return {at_end ? (rows - 1) * columns : 0, 1, columns};
  return {at_end ? columns - 1 : 0, columns, rows};
}

bool is_collapsed(const ControlNet& net, const NetEdge& edge) {
  return extent_of_edge(net, edge) <= collapsed_edge_fraction * bounding_box(net).size();
}

std::vector<NetEdge> find_collapsed_edges(const Surface& surface) {
  std::vector<NetEdge> edges;
  for (const bool at_end : {false, true}) {
    for (const bool of_u : {true, false}) {
      const NetEdge edge = find_edge(surface.net, of_u, at_end);
      const KnotVector& knots = of_u ? surface.u : surface.v;
      if (knots.is_clamped(at_end) && is_collapsed(surface.net, edge)) edges.push_back(edge);
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
