#include "engine/fitting/harmonic_map.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

double edge_weight(const PointGraph& graph, std::uint32_t a, std::uint32_t b, double length) {
  const double fraction = graph.length(a, b) / length;
  return 1.0 / (0.25 + fraction * fraction);
}

// Returns f that minimises the sum of w (f_b - f_a - jump(a, b))^2 over the edges for which use(a, b) is
// true. `fixed` holds given values of f, and NaN where f is unknown. A weak spring to zero determines f at
// nodes without edges. Returns nothing if the system is singular.
template <class Use, class Jump>
std::optional<Eigen::VectorXd> solve_harmonic(const PointGraph& graph, const std::vector<double>& fixed,
                                              const Use& use, const Jump& jump) {
  const double length = mean_edge_length(graph);
  std::vector<int> index(graph.size(), -1);
  int count = 0;
  for (std::size_t n = 0; n < graph.size(); ++n) {
    if (std::isnan(fixed[n])) index[n] = count++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.neighbours.size() + graph.size());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::uint32_t a = 0; a < graph.size(); ++a) {
    if (index[a] < 0) continue;
    double diagonal = 1e-9;
    for (const std::uint32_t b : graph.adjacent(a)) {
      if (!use(a, b)) continue;
      const double weight = edge_weight(graph, a, b, length);
      diagonal += weight;
      right[index[a]] -= weight * jump(a, b);
      if (index[b] < 0) {
        right[index[a]] += weight * fixed[b];
      } else if (index[a] > index[b]) {
        entries.emplace_back(index[a], index[b], -weight);
      }
    }
    entries.emplace_back(index[a], index[a], diagonal);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success) return {};
  const Eigen::VectorXd solution = factor.solve(right);
  if (!solution.allFinite()) return {};
  Eigen::VectorXd all(static_cast<Eigen::Index>(graph.size()));
  for (std::size_t n = 0; n < graph.size(); ++n) {
    all[static_cast<Eigen::Index>(n)] = index[n] < 0 ? fixed[n] : solution[index[n]];
  }
  return all;
}

// Increasing piecewise linear function through the points (key[k], value[k]).
struct RisingTable {
  std::vector<double> key, value;
  double at(double k) const {
    const auto above = static_cast<std::size_t>(std::upper_bound(key.begin(), key.end(), k) - key.begin());
    if (above == 0) return value.front();
    if (above == key.size()) return value.back();
    const double fraction = (k - key[above - 1]) / std::max(key[above] - key[above - 1], 1e-300);
    return value[above - 1] + fraction * (value[above] - value[above - 1]);
  }
};

// Builds an increasing table from (0, 0) to (1, 1). The entries in between are means over groups of equal
// size, sorted by key.
RisingTable rising_means(const Eigen::VectorXd& key, const std::vector<double>& value, std::size_t groups) {
  std::vector<Eigen::Index> order(value.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key[a] < key[b]; });
  RisingTable table{{0.0}, {0.0}};
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t begin = g * order.size() / groups, end = (g + 1) * order.size() / groups;
    double keys = 0.0, values = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      keys += key[order[k]];
      values += value[static_cast<std::size_t>(order[k])];
    }
    if (begin == end) continue;
    const double count = static_cast<double>(end - begin), mean = values / count;
    if (keys / count <= table.key.back() || mean <= table.value.back() || mean >= 1.0) continue;
    table.key.push_back(keys / count);
    table.value.push_back(mean);
  }
  table.key.push_back(std::max(1.0, std::nextafter(table.key.back(), 2.0)));
  table.value.push_back(1.0);
  return table;
}

std::optional<std::vector<double>> compute_v(const PointGraph& graph, const ShapeEnds& ends) {
  std::vector<double> fixed(graph.size(), not_a_number);
  for (const std::uint32_t node : ends.start) fixed[node] = 0.0;
  for (const std::uint32_t node : ends.end) fixed[node] = 1.0;
  const auto harmonic = solve_harmonic(
      graph, fixed, [](auto, auto) { return true; }, [](auto, auto) { return 0.0; });
  if (!harmonic) return {};
  const ShortestPaths from = shortest_paths(graph, ends.start), to = shortest_paths(graph, ends.end);
  std::vector<double> fraction(graph.size());
  for (std::size_t n = 0; n < graph.size(); ++n) {
    fraction[n] = from.length[n] / std::max(from.length[n] + to.length[n], 1e-300);
    if (!std::isfinite(fraction[n])) return {};
  }
  const RisingTable table =
      rising_means(*harmonic, fraction, std::min<std::size_t>(100, graph.size() / 8 + 1));
  std::vector<double> v(graph.size());
  for (std::size_t n = 0; n < graph.size(); ++n) v[n] = table.at((*harmonic)[static_cast<Eigen::Index>(n)]);
  return v;
}

// Returns the local surface normal, of either sign: the direction in which the nodes within two edges spread
// least.
Vector3 estimate_local_normal(const PointGraph& graph, std::uint32_t node) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3 mean = graph.points_m[node];
  for (const std::uint32_t other : graph.adjacent(node)) mean += graph.points_m[other];
  mean /= static_cast<double>(graph.adjacent(node).size() + 1);
  const auto add = [&](const Vector3& point) { spread += (point - mean) * (point - mean).transpose(); };
  add(graph.points_m[node]);
  for (const std::uint32_t other : graph.adjacent(node)) {
    add(graph.points_m[other]);
    for (const std::uint32_t further : graph.adjacent(other)) add(graph.points_m[further]);
  }
  return decompose_symmetric(spread).vectors.col(0);
}

enum class SquareSide : unsigned char { none, left, right };

// A cut along the shortest path between the ends. For a node near the path, `side` is the side of the path on
// which the node is; for all other nodes it is SquareSide::none.
struct Cut {
  std::vector<SquareSide> side;
  std::vector<bool> near_pole;
};

std::vector<std::uint32_t> shortest_path(const PointGraph& graph, const ShapeEnds& ends) {
  const ShortestPaths paths = shortest_paths(graph, ends.start);
  std::uint32_t node = *std::min_element(ends.end.begin(), ends.end.end(),
                                         [&](auto a, auto b) { return paths.length[a] < paths.length[b]; });
  std::vector<std::uint32_t> path{node};
  while (paths.predecessor[node] != node) path.push_back(node = paths.predecessor[node]);
  return path;
}

void mark_around(const PointGraph& graph, std::uint32_t node, int rings, std::vector<bool>& marks) {
  marks[node] = true;
  if (rings == 0) return;
  for (const std::uint32_t other : graph.adjacent(node)) mark_around(graph, other, rings - 1, marks);
}

// Returns, for each node of the path, the unit vector within the surface that points to the left of the path.
// The sign of each vector follows from the mean of many previous vectors, so that it stays consistent across
// sharp edges.
std::vector<Vector3> compute_lefts(const PointGraph& graph, const std::vector<std::uint32_t>& path) {
  constexpr std::size_t reach = 3, memory = 14;
  std::vector<Vector3> lefts(path.size());
  for (std::size_t k = 0; k < path.size(); ++k) {
    const std::size_t back = k < reach ? 0 : k - reach, ahead = std::min(path.size() - 1, k + reach);
    const Vector3 along = graph.points_m[path[ahead]] - graph.points_m[path[back]];
    lefts[k] = estimate_local_normal(graph, path[k]).cross(along).normalized();
    Vector3 before = Vector3::Zero();
    for (std::size_t b = k < memory ? 0 : k - memory; b < k; ++b) before += lefts[b];
    if (lefts[k].dot(before) < 0.0) lefts[k] = -lefts[k];
  }
  std::vector<Vector3> smooth(path.size());
  for (std::size_t k = 0; k < path.size(); ++k) {
    Vector3 sum = Vector3::Zero();
    for (std::size_t m = k < reach ? 0 : k - reach; m <= std::min(path.size() - 1, k + reach); ++m) {
      sum += lefts[m];
    }
    smooth[k] = sum.normalized();
  }
  return smooth;
}

Cut cut_between(const PointGraph& graph, const ShapeEnds& ends) {
  const std::vector<std::uint32_t> path = shortest_path(graph, ends);
  const std::vector<Vector3> lefts = compute_lefts(graph, path);
  Cut cut{std::vector<SquareSide>(graph.size(), SquareSide::none), std::vector<bool>(graph.size(), false)};
  std::vector<double> distance(graph.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Vector3& at = graph.points_m[path[k]];
    const auto offer = [&](std::uint32_t node) {
      const double away = graph.length(node, path[k]);
      if (away >= distance[node]) return;
      distance[node] = away;
      cut.side[node] = (graph.points_m[node] - at).dot(lefts[k]) > 0.0 ? SquareSide::left : SquareSide::right;
    };
    for (const std::uint32_t other : graph.adjacent(path[k])) {
      offer(other);
      for (const std::uint32_t further : graph.adjacent(other)) offer(further);
    }
  }
  for (const std::uint32_t node : path) cut.side[node] = SquareSide::right;
  for (const auto* end : {&ends.start, &ends.end}) {
    if (end->size() == 1) mark_around(graph, end->front(), 2, cut.near_pole);
  }
  return cut;
}

std::optional<std::vector<double>> compute_u(const PointGraph& graph, const ShapeEnds& ends) {
  const Cut cut = cut_between(graph, ends);
  const auto use = [&](std::uint32_t a, std::uint32_t b) { return !cut.near_pole[a] && !cut.near_pole[b]; };
  const auto jump = [&](std::uint32_t a, std::uint32_t b) {
    if (cut.side[a] == SquareSide::right && cut.side[b] == SquareSide::left) return -1.0;
    if (cut.side[a] == SquareSide::left && cut.side[b] == SquareSide::right) return 1.0;
    return 0.0;
  };
  std::vector<double> fixed(graph.size(), not_a_number);
  const std::vector<std::uint32_t> path = shortest_path(graph, ends);
  fixed[path[path.size() / 2]] = 0.0;
  const auto harmonic = solve_harmonic(graph, fixed, use, jump);
  if (!harmonic) return {};
  std::size_t torn = 0, edges = 0;
  std::vector<double> u(graph.size(), not_a_number);
  for (std::uint32_t a = 0; a < graph.size(); ++a) {
    const double value = (*harmonic)[a];
    if (!cut.near_pole[a]) u[a] = value - std::floor(value);
    for (const std::uint32_t b : graph.adjacent(a)) {
      if (!use(a, b)) continue;
      ++edges;
      if (std::abs((*harmonic)[b] - value - jump(a, b)) > 0.3) ++torn;
    }
  }
  if (edges == 0 || torn > edges / 50) return {};
  return u;
}

}  // namespace

Result<std::vector<Vector2>> harmonic_tube_map(const PointGraph& graph, const ShapeEnds& ends) {
  SPOONBILL_ASSERT(!ends.start.empty() && !ends.end.empty());
  const auto v = compute_v(graph, ends);
  if (!v) return Error(ErrorCode::degenerate, "its points are not connected from end to end");
  const auto u = compute_u(graph, ends);
  if (!u)
    return Error(ErrorCode::degenerate,
                 "no closed path around it was found: it has a handle, or too few points");
  std::vector<Vector2> uv(graph.size());
  for (std::size_t n = 0; n < uv.size(); ++n) uv[n] = {(*u)[n], (*v)[n]};
  return uv;
}

Result<std::vector<Vector2>> harmonic_square_map(const PointGraph& graph,
                                                 const std::vector<std::uint32_t>& loop,
                                                 const std::array<std::size_t, 4>& corners) {
  SPOONBILL_ASSERT(loop.size() >= 4);
  // The corners must be in the order of the loop, which may start between any two corners.
  const auto ahead = [&](std::size_t c) { return (corners[c] + loop.size() - corners[0]) % loop.size(); };
  SPOONBILL_ASSERT(0 < ahead(1) && ahead(1) < ahead(2) && ahead(2) < ahead(3));
  static const std::array<Vector2, 4> square{Vector2(0, 0), Vector2(1, 0), Vector2(1, 1), Vector2(0, 1)};
  std::array<std::vector<double>, 2> fixed;
  fixed.fill(std::vector<double>(graph.size(), not_a_number));
  for (std::size_t side = 0; side < 4; ++side) {
    const std::size_t begin = corners[side];
    const std::size_t steps = (corners[(side + 1) % 4] + loop.size() - begin) % loop.size();
    std::vector<double> length(steps + 1, 0.0);
    const auto at = [&](std::size_t k) { return loop[(begin + k) % loop.size()]; };
    for (std::size_t k = 1; k <= steps; ++k) length[k] = length[k - 1] + graph.length(at(k - 1), at(k));
    for (std::size_t k = 0; k < steps; ++k) {
      const double fraction = length[k] / std::max(length[steps], 1e-300);
      const Vector2 index = square[side] + fraction * (square[(side + 1) % 4] - square[side]);
      fixed[0][at(k)] = index.x();
      fixed[1][at(k)] = index.y();
    }
  }
  std::vector<Vector2> uv(graph.size());
  for (int axis = 0; axis < 2; ++axis) {
    const auto values = solve_harmonic(
        graph, fixed[static_cast<std::size_t>(axis)], [](auto, auto) { return true; },
        [](auto, auto) { return 0.0; });
    if (!values) return Error(ErrorCode::degenerate, "its points are not connected");
    for (std::size_t n = 0; n < uv.size(); ++n) {
      uv[n][axis] = std::clamp((*values)[static_cast<Eigen::Index>(n)], 0.0, 1.0);
    }
  }
  return uv;
}

ShapeEnds farthest_ends(const PointGraph& graph) {
  SPOONBILL_ASSERT(graph.size() > 0);
  // Chooses the node nearest to the centroid of the 4 % of the nodes that are farthest from `from`. They
  // cover one end of the shape, whereas the single farthest node may be at any corner of that end.
  constexpr double nearly = 0.04;
  const auto farthest = [&](std::uint32_t from) {
    const std::array<std::uint32_t, 1> source{from};
    const ShortestPaths paths = shortest_paths(graph, source);
    std::vector<std::uint32_t> order(graph.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto count =
        std::max<std::size_t>(1, static_cast<std::size_t>(nearly * static_cast<double>(order.size())));
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                      [&](auto a, auto b) { return paths.length[a] > paths.length[b]; });
    order.resize(count);
    Vector3 centre = Vector3::Zero();
    for (const std::uint32_t node : order) centre += graph.points_m[node] / static_cast<double>(count);
    return *std::min_element(order.begin(), order.end(), [&](auto a, auto b) {
      return (graph.points_m[a] - centre).norm() < (graph.points_m[b] - centre).norm();
    });
  };
  std::uint32_t a = farthest(0), b = farthest(a);
  a = farthest(b);
  b = farthest(a);
  return {{a}, {b}};
}

}  // namespace spoonbill
