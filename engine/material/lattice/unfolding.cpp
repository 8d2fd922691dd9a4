#include "engine/material/lattice/unfolding.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace spoonbill {
namespace {

constexpr int sweeps = 60, halvings = 10;
// Of the mean edges: where a sweep moves no node further, it was the last.
constexpr double still = 1e-3;
// Of the volume of a box of the mean edges: corners below it are lifted by d.
constexpr double least_determinant = 1e-2;

// A cell by its nodes, and which of its corners the node in question is.
struct CellAround {
  std::array<int, 8> nodes;
  int corner;
};

std::vector<CellAround> cells_around(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.place(node);
  std::vector<CellAround> cells;
  for (int c = 0; c < 8; ++c) {
    std::array<int, 3> first = {at[0] - (c >> 2 & 1), at[1] - (c >> 1 & 1), at[2] - (c & 1)};
    if (mesh.closed) first[0] = (first[0] + mesh.count[0] - 1) % (mesh.count[0] - 1);
    bool exists = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      exists = exists && first[axis] >= 0 && first[axis] + 1 < mesh.count[axis];
    }
    if (!exists) continue;
    CellAround cell{{}, c};
    for (int other = 0; other < 8; ++other) {
      cell.nodes[static_cast<std::size_t>(other)] = mesh.joined(
          mesh.index(first[0] + (other >> 2 & 1), first[1] + (other >> 1 & 1), first[2] + (other & 1)));
    }
    cells.push_back(cell);
  }
  return cells;
}

Vector3 mean_edges(const LatticeMesh& mesh) {
  Vector3 sums = Vector3::Zero(), edges = Vector3::Zero();
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.place(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<int, 3> next = at;
      if (++next[axis] == mesh.count[axis]) continue;
      const auto index = static_cast<Eigen::Index>(axis);
      sums[index] += (mesh.nodes[static_cast<std::size_t>(mesh.index(next[0], next[1], next[2]))] -
                      mesh.nodes[static_cast<std::size_t>(n)])
                         .norm();
      edges[index] += 1.0;
    }
  }
  return sums.cwiseQuotient(edges);
}

// One corner of a cell: its edges over the mean ones, and how each follows the node in question, 0 or +-1
// over the mean edge.
struct Corner {
  std::array<Vector3, 3> edges;
  Vector3 follows;
  double determinant() const { return edges[0].dot(edges[1].cross(edges[2])); }
};

// The sum of the terms, its gradient and its second derivatives.
struct Sum {
  double value = 0.0;
  Vector3 gradient = Vector3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

void add_term(const Corner& corner, double lift_square, Sum& sum) {
  const auto& [a, b, c] = corner.edges;
  const std::array<Vector3, 3> cofactors = {b.cross(c), c.cross(a), a.cross(b)};
  Vector3 of_square = Vector3::Zero(), of_determinant = Vector3::Zero();
  double square = 0.0, twice = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double follows = corner.follows[static_cast<Eigen::Index>(axis)];
    square += corner.edges[axis].squaredNorm() / 3.0;
    of_square += 2.0 / 3.0 * follows * corner.edges[axis];
    of_determinant += follows * cofactors[axis];
    twice += 2.0 / 3.0 * follows * follows;
  }
  const double x = corner.determinant(), root = std::sqrt(x * x + 4.0 * lift_square);
  const double lifted = 0.5 * (x + root), size = std::sqrt(square);
  if (!(lifted > 0.0)) {
    sum.value = std::numeric_limits<double>::infinity();
    return;
  }
  const double power = square * size, slope = lifted / root, bend = 2.0 * lift_square / (root * root * root);
  const Vector3 of_power = 1.5 * size * of_square;
  sum.value += power / lifted;
  sum.gradient += of_power / lifted - power * slope / (lifted * lifted) * of_determinant;
  const Eigen::Matrix3d mixed = of_power * of_determinant.transpose();
  sum.second +=
      (1.5 * size * twice * Eigen::Matrix3d::Identity() + 0.75 / size * of_square * of_square.transpose()) /
          lifted -
      slope / (lifted * lifted) * (mixed + mixed.transpose()) +
      power * (2.0 * slope * slope / lifted - bend) / (lifted * lifted) * of_determinant *
          of_determinant.transpose();
}

// The corners that a node is one of the four ends of.
class Around {
 public:
  Around(const LatticeMesh& mesh, int node, const Vector3& mean_edge)
      : mesh_(&mesh), cells_(cells_around(mesh, node)), mean_edge_(&mean_edge) {}

  template <class Visit>
  void visit(const Visit& visit) const {
    for (const CellAround& cell : cells_) {
      visit(corner(cell, cell.corner, 7));
      for (const int bit : {4, 2, 1}) visit(corner(cell, cell.corner ^ bit, bit));
    }
  }

  Sum sum(double lift_square) const {
    Sum sum;
    visit([&](const Corner& corner) { add_term(corner, lift_square, sum); });
    return sum;
  }

  double least_determinant() const {
    double least = std::numeric_limits<double>::infinity();
    visit([&](const Corner& corner) { least = std::min(least, corner.determinant()); });
    return least;
  }

 private:
  // `moving`: the axes whose edges follow the node.
  Corner corner(const CellAround& cell, int at, int moving) const {
    const auto node = [&](int corner) -> const Vector3& {
      return mesh_->nodes[static_cast<std::size_t>(cell.nodes[static_cast<std::size_t>(corner)])];
    };
    Corner result{{}, Vector3::Zero()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int bit = 4 >> axis;
      const double edge = (*mean_edge_)[static_cast<Eigen::Index>(axis)];
      result.edges[axis] = (node(at | bit) - node(at & ~bit)) / edge;
      if ((moving & bit) == 0) continue;
      result.follows[static_cast<Eigen::Index>(axis)] = ((cell.corner & bit) != 0 ? 1.0 : -1.0) / edge;
    }
    return result;
  }

  const LatticeMesh* mesh_;
  std::vector<CellAround> cells_;
  const Vector3* mean_edge_;
};

// Newton's, made definite where it is not.
Vector3 step_of(const Sum& sum) {
  constexpr int tries = 7;
  const double size = sum.second.diagonal().cwiseAbs().sum();
  double added = 0.0;
  for (int attempt = 0; attempt < tries; ++attempt) {
    const Eigen::LLT<Eigen::Matrix3d> factor(sum.second + added * size * Eigen::Matrix3d::Identity());
    if (factor.info() == Eigen::Success) return -factor.solve(sum.gradient);
    added = attempt == 0 ? 1e-2 : 4.0 * added;
  }
  return -sum.gradient / size;
}

// Returns how far the node went.
double move_node(const Around& around, double lift_square, Vector3& node) {
  const Sum sum = around.sum(lift_square);
  if (!std::isfinite(sum.value)) return 0.0;
  const Vector3 before = node, step = step_of(sum);
  if (!step.allFinite()) return 0.0;
  double share = 1.0;
  for (int halving = 0; halving <= halvings; ++halving, share *= 0.5) {
    node = before + share * step;
    if (around.sum(lift_square).value < sum.value) return share * step.norm();
  }
  node = before;
  return 0.0;
}

}  // namespace

void fill_from_hull(LatticeMesh& mesh) {
  const std::array<int, 3> last = {mesh.count[0] - 1, mesh.count[1] - 1, mesh.count[2] - 1};
  for (int n = 0; n < mesh.node_count(); ++n) {
    const std::array<int, 3> at = mesh.place(n);
    if (mesh.place_of(at[0], at[1], at[2]) != NodePlace::in_body) continue;
    Vector3 point = Vector3::Zero();
    // Faces, less edges, and corners: at an end of one axis, of two, of three.
    for (int ends = 1; ends < 27; ++ends) {
      const std::array<int, 3> end = {ends / 9, ends / 3 % 3, ends % 3};  // 0: not at an end of this axis
      if (mesh.closed && end[0] != 0) continue;
      double weight = -1.0;
      std::array<int, 3> from = at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (end[axis] == 0) continue;
        const double share = static_cast<double>(at[axis]) / last[axis];
        weight *= end[axis] == 1 ? share - 1.0 : -share;
        from[axis] = end[axis] == 1 ? 0 : last[axis];
      }
      point += weight * mesh.nodes[static_cast<std::size_t>(mesh.index(from[0], from[1], from[2]))];
    }
    mesh.nodes[static_cast<std::size_t>(n)] = point;
  }
}

void unfold(LatticeMesh& mesh, const std::vector<int>& movable) {
  const Vector3 mean_edge = mean_edges(mesh);
  std::vector<Around> around;
  around.reserve(movable.size());
  for (const int node : movable) around.emplace_back(mesh, node, mean_edge);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double least = std::numeric_limits<double>::infinity(), farthest = 0.0;
    for (const Around& one : around) least = std::min(least, one.least_determinant());
    const double lift_square =
        least < least_determinant ? least_determinant * (least_determinant - least) : 0.0;
    for (std::size_t m = 0; m < movable.size(); ++m) {
      Vector3& node = mesh.nodes[static_cast<std::size_t>(movable[m])];
      farthest = std::max(farthest, move_node(around[m], lift_square, node));
      mesh.nodes[static_cast<std::size_t>(mesh.twin(movable[m]))] = node;
    }
    if (least > 0.0 && farthest < still * mean_edge.minCoeff()) break;
  }
}

double smallest_jacobian_ratio(const LatticeMesh& mesh) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0), high = 1.0 - low;
  double smallest = std::numeric_limits<double>::infinity();
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        const CellCorners cell = mesh.cell(i, j, k);
        const double volume = cell_volume(cell);
        if (!(volume > 0.0)) return -1.0;
        smallest = std::min(smallest, smallest_jacobian_ratio(cell));
        for (int c = 0; c < 8; ++c) {
          const Eigen::Matrix3d jacobian = trilinear_jacobian(
              cell, (c & 4) != 0 ? high : low, (c & 2) != 0 ? high : low, (c & 1) != 0 ? high : low);
          smallest = std::min(smallest, jacobian.determinant() / volume);
        }
      }
    }
  }
  return smallest;
}

}  // namespace spoonbill
