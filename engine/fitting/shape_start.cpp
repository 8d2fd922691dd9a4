#include "engine/fitting/shape_start.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/base/geometry.h"
#include "engine/fitting/harmonic_map.h"

namespace spoonbill {
namespace {

constexpr double sheet_share = 0.12;
// Of what faces out of its rim, as a body seen from outside does, or may do so: it may have lost its foot.
constexpr double outward_sheet_share = 0.3;
constexpr double tube_share = 0.75;
constexpr double roundness = 0.12;

Vector3 area_within(const PointGraph& graph, const Rim& rim) {
  Vector3 area = Vector3::Zero();
  for (std::size_t k = 0; k < rim.nodes.size(); ++k) {
    const Vector3 a = graph.points_m[rim.nodes[k]] - rim.centre_m;
    area += 0.5 * a.cross(graph.points_m[rim.nodes[(k + 1) % rim.nodes.size()]] - rim.centre_m);
  }
  return area;
}

// What each node stands for: a hexagon of the lattice that its edges would make.
std::vector<double> areas_of(const PointGraph& graph) {
  std::vector<double> areas(graph.size(), 0.0);
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    const auto near = graph.of(n);
    for (const std::uint32_t other : near) {
      areas[n] +=
          0.6 * (graph.points_m[n] - graph.points_m[other]).squaredNorm() / static_cast<double>(near.size());
    }
  }
  return areas;
}

double area_of(const PointGraph& graph) {
  const std::vector<double> areas = areas_of(graph);
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

// The surface's middle and main axes, the longest last.
struct Axes {
  Vector3 middle = Vector3::Zero();
  Vector3 squares = Vector3::Zero();  // mean squared extents, rising
  Eigen::Matrix3d axes;
};

Axes axes_of(const PointGraph& graph) {
  Axes result;
  const std::vector<double> areas = areas_of(graph);
  const double area = std::accumulate(areas.begin(), areas.end(), 1e-300);
  for (std::size_t n = 0; n < areas.size(); ++n) result.middle += areas[n] / area * graph.points_m[n];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t n = 0; n < areas.size(); ++n) {
    const Vector3 way = graph.points_m[n] - result.middle;
    spread += areas[n] / area * way * way.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  result.squares = solver.eigenvalues();
  result.axes = solver.eigenvectors();
  return result;
}

void span_holes(FitPoints& island, std::size_t first_rim) {
  for (std::size_t k = first_rim; k < island.rims.size(); ++k) {
    const Cap cap = cap_over(island.graph, island.rims[k], static_cast<std::uint32_t>(island.graph.size()));
    add_spanning_nodes(island, cap.points_m, cap.normals, cap.pairs);
  }
}

// Nodes that lie nearer to the axis than all around them, no two close together.
std::vector<std::uint32_t> nodes_on_axis(const PointGraph& graph, const Vector3& middle,
                                         const Vector3& axis) {
  std::vector<double> radius(graph.size());
  double widest = 0.0;
  for (std::size_t n = 0; n < graph.size(); ++n) {
    radius[n] = (graph.points_m[n] - middle).cross(axis).norm();
    widest = std::max(widest, radius[n]);
  }
  std::vector<std::uint32_t> order;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    const auto near = graph.of(n);
    const bool lowest = std::all_of(near.begin(), near.end(), [&](auto m) { return radius[m] >= radius[n]; });
    if (lowest && radius[n] < 0.15 * widest) order.push_back(n);
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return radius[a] < radius[b]; });
  std::vector<std::uint32_t> chosen;
  std::vector<bool> covered(graph.size(), false);
  for (const std::uint32_t n : order) {
    if (covered[n]) continue;
    const ShortestWays ways = shortest_ways(graph, std::array<std::uint32_t, 1>{n});
    for (std::size_t m = 0; m < graph.size(); ++m) covered[m] = covered[m] || ways.length[m] < 0.4 * widest;
    chosen.push_back(n);
  }
  return chosen;
}

// Where an axis through the middle leaves the shape, if it does so at two places.
std::optional<ShapeEnds> poles_on(const PointGraph& graph, const Vector3& middle, const Vector3& axis) {
  const std::vector<std::uint32_t> on_axis = nodes_on_axis(graph, middle, axis);
  if (on_axis.size() != 2) return {};
  const auto height = [&](std::uint32_t n) { return (graph.points_m[n] - middle).dot(axis); };
  return height(on_axis[0]) < height(on_axis[1]) ? ShapeEnds{{on_axis[0]}, {on_axis[1]}}
                                                 : ShapeEnds{{on_axis[1]}, {on_axis[0]}};
}

// About the short axis of what is round and flat (a bowl, a plate), else about the long one.
std::optional<ShapeEnds> poles_on_axis(const PointGraph& graph) {
  const Axes axes = axes_of(graph);
  const bool is_disc = axes.squares[2] - axes.squares[1] < roundness * axes.squares[2] &&
                       axes.squares[1] - axes.squares[0] > roundness * axes.squares[2];
  return poles_on(graph, axes.middle, axes.axes.col(is_disc ? 0 : 2));
}

// Whether normals point away from the middle, as they do where the inside of a closed shape was not seen.
bool faces_outwards(const FitPoints& island) {
  const Axes axes = axes_of(island.graph);
  const std::vector<double> areas = areas_of(island.graph);
  double volume = 0.0;
  for (std::size_t n = 0; n < areas.size(); ++n) {
    volume += areas[n] * (island.graph.points_m[n] - axes.middle).dot(island.node_normals[n]);
  }
  return volume >= 0.0;  // zero without normals
}

// Of a scan that is inside out.
void turn_normals(FitPoints& island) {
  for (Vector3& normal : island.scan.normals) normal = -normal;
  for (Vector3& normal : island.node_normals) normal = -normal;
}

Result<Parameterisation> closed_start(FitPoints& island) {
  if (!faces_outwards(island)) turn_normals(island);
  span_holes(island, 0);
  const ShapeEnds ends = poles_on_axis(island.graph).value_or(farthest_ends(island.graph));
  auto uv = harmonic_tube_map(island.graph, ends);
  if (!uv) return uv.error();
  uv.value()[ends.start.front()] = {0.0, 0.0};
  uv.value()[ends.end.front()] = {0.0, 1.0};
  return Parameterisation{ShapeKind::closed, std::move(uv).value()};
}

Result<Parameterisation> tube_start(FitPoints& island) {
  if (island.rims.size() < 2) {
    return Error{"a tube needs two open ends, " + std::to_string(island.rims.size()) +
                 " found; try --kind closed"};
  }
  const ShapeEnds ends{island.rims[0].nodes, island.rims[1].nodes};
  span_holes(island, 2);
  auto uv = harmonic_tube_map(island.graph, ends);
  if (!uv) return uv.error();
  return Parameterisation{ShapeKind::tube, std::move(uv).value()};
}

// Where along the rim the corners of the square go: to the nodes farthest out on the diagonals of its plane.
std::array<std::size_t, 4> corners_of(const PointGraph& graph, const Rim& rim) {
  const Axes axes = axes_of(graph);
  std::array<std::size_t, 4> corners{};
  static constexpr std::array<std::array<double, 2>, 4> diagonals{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  const double wide = std::sqrt(axes.squares[2]), narrow = std::sqrt(axes.squares[1]);
  for (std::size_t c = 0; c < 4; ++c) {
    double most = -1e300;
    for (std::size_t k = 0; k < rim.nodes.size(); ++k) {
      const Vector3 way = graph.points_m[rim.nodes[k]] - axes.middle;
      const double out = diagonals[c][0] * way.dot(axes.axes.col(2)) / wide +
                         diagonals[c][1] * way.dot(axes.axes.col(1)) / narrow;
      if (out <= most) continue;
      most = out;
      corners[c] = k;
    }
  }
  return corners;
}

// Height over the plane in which the points spread: for sheets that no line across it meets twice.
Parameterisation plane_start(const FitPoints& island) {
  const Axes axes = axes_of(island.graph);
  Parameterisation start;
  Box2 box;
  for (const Vector3& point : island.graph.points_m) {
    const Vector2 place((point - axes.middle).dot(axes.axes.col(2)),
                        (point - axes.middle).dot(axes.axes.col(1)));
    start.uv.push_back(place);
    box.include(place);
  }
  for (Vector2& place : start.uv) place = (place - box.low).cwiseQuotient(box.extent().cwiseMax(1e-12));
  return start;
}

Result<Parameterisation> sheet_start(FitPoints& island) {
  if (island.rims.empty()) return plane_start(island);
  span_holes(island, 1);
  std::array<std::size_t, 4> corners = corners_of(island.graph, island.rims[0]);
  // In the order of the rim, whichever way round it runs.
  Rim rim = island.rims[0];
  const std::size_t count = rim.nodes.size();
  const auto ahead = [&](std::size_t c) { return (corners[c] + count - corners[0]) % count; };
  if (ahead(1) > ahead(3)) {
    std::reverse(rim.nodes.begin(), rim.nodes.end());
    for (std::size_t& corner : corners) corner = count - 1 - corner;
  }
  if (!(0 < ahead(1) && ahead(1) < ahead(2) && ahead(2) < ahead(3))) return plane_start(island);
  auto uv = harmonic_square_map(island.graph, rim.nodes, corners);
  if (!uv) return uv.error();
  return Parameterisation{ShapeKind::sheet, std::move(uv).value()};
}

}  // namespace

ShapeKind kind_of_shape(const FitPoints& island) {
  if (island.rims.empty()) return ShapeKind::closed;
  const double area = area_of(island.graph);
  if (island.rims.size() > 1) {
    const ShortestWays ways = shortest_ways(island.graph, island.rims[0].nodes);
    double between = 0.0;
    for (const std::uint32_t node : island.rims[1].nodes) between = std::max(between, ways.length[node]);
    const double around = area / std::max(between, 1e-12);
    if (std::isfinite(between) && island.rims[1].length_m > tube_share * around &&
        island.rims[0].length_m < around / tube_share && island.rims[0].length_m > tube_share * around) {
      return ShapeKind::tube;
    }
  }
  const double share = area_within(island.graph, island.rims[0]).norm() / area;
  return share > (faces_outwards(island) ? outward_sheet_share : sheet_share) ? ShapeKind::sheet
                                                                              : ShapeKind::closed;
}

void span_all_holes(FitPoints& island) {
  span_holes(island, 0);
  island.rims.clear();
}

Result<Parameterisation> first_parameters(FitPoints& island, ShapeKind kind) {
  switch (kind) {
    case ShapeKind::closed:
      return closed_start(island);
    case ShapeKind::tube:
      return tube_start(island);
    default:
      return sheet_start(island);
  }
}

}  // namespace spoonbill
