#include "engine/bspline/polygon_crossing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

struct Edge {
  Eigen::Vector2d from, to;
  std::size_t polygon = 0;

  double low_x() const { return std::min(from.x(), to.x()); }
  double high_x() const { return std::max(from.x(), to.x()); }
  double low_y() const { return std::min(from.y(), to.y()); }
  double high_y() const { return std::max(from.y(), to.y()); }
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// In units of the tolerance, so that 1 is what still touches.
std::vector<Edge> edges_of(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                           const Eigen::Vector2d& tolerance) {
  std::vector<Edge> edges;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    const auto& corners = polygons[p];
    for (std::size_t c = 0; c < corners.size(); ++c) {
      edges.push_back({corners[c].cwiseQuotient(tolerance),
                       corners[(c + 1) % corners.size()].cwiseQuotient(tolerance), p});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.low_x() < b.low_x(); });
  return edges;
}

bool touches(const Eigen::Vector2d& point, const Edge& edge) {
  const Eigen::Vector2d along = edge.to - edge.from;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((point - edge.from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (edge.from + share * along - point).squaredNorm() <= 1.0;
}

bool cross_each_other(const Edge& a, const Edge& b) {
  const Eigen::Vector2d along_a = a.to - a.from, along_b = b.to - b.from;
  const auto sides_differ = [](double one, double other) { return (one > 0.0) != (other > 0.0); };
  if (!sides_differ(cross(along_a, b.from - a.from), cross(along_a, b.to - a.from))) return false;
  if (!sides_differ(cross(along_b, a.from - b.from), cross(along_b, a.to - b.from))) return false;
  return !touches(a.from, b) && !touches(a.to, b) && !touches(b.from, a) && !touches(b.to, a);
}

}  // namespace

std::optional<PolygonCrossing> find_crossing(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                             const Eigen::Vector2d& tolerance) {
  SPOONBILL_ASSERT(tolerance.x() > 0.0 && tolerance.y() > 0.0);
  const std::vector<Edge> edges = edges_of(polygons, tolerance);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double high_x = edges[i].high_x(), low_y = edges[i].low_y(), high_y = edges[i].high_y();
    for (std::size_t j = i + 1; j < edges.size() && edges[j].low_x() <= high_x; ++j) {
      if (edges[j].low_y() > high_y || edges[j].high_y() < low_y) continue;
      if (!cross_each_other(edges[i], edges[j])) continue;
      const auto [first, second] = std::minmax(edges[i].polygon, edges[j].polygon);
      // Of the shorter edge, the middle is the nearer to where they cross.
      const Edge& shorter =
          (edges[i].to - edges[i].from).norm() < (edges[j].to - edges[j].from).norm() ? edges[i] : edges[j];
      return PolygonCrossing{first, second, (0.5 * (shorter.from + shorter.to)).cwiseProduct(tolerance)};
    }
  }
  return std::nullopt;
}

}  // namespace spoonbill
