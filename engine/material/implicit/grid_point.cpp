#include "engine/material/implicit/grid_point.h"

#include <algorithm>

#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

// Position of a node of one grid in another grid over the same body, along one axis.
struct GridPosition {
  int first;
  double fraction;  // position between this node and the next, from 0 to 1
};

GridPosition locate_in(int at, int count, int other_count) {
  const double coordinate = static_cast<double>(at) * (other_count - 1) / (count - 1);
  const int first = std::min(static_cast<int>(coordinate), other_count - 2);
  return {first, coordinate - first};
}

}  // namespace

GridPoint embed_node(const LatticeMesh& of, int node, const LatticeMesh& by) {
  const std::array<int, 3> at = of.grid_index(node);
  std::array<GridPosition, 3> positions{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    positions[axis] = locate_in(at[axis], of.count[axis], by.count[axis]);
  }
  GridPoint result;
  for (int c = 0; c < 8; ++c) {
    const std::array<int, 3> high = {c >> 2 & 1, c >> 1 & 1, c & 1};
    std::array<int, 3> corner{};
    double weight = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner[axis] = positions[axis].first + high[axis];
      weight *= high[axis] ? positions[axis].fraction : 1.0 - positions[axis].fraction;
    }
    result.node[static_cast<std::size_t>(c)] = by.joined(by.index(corner[0], corner[1], corner[2]));
    result.weight[static_cast<std::size_t>(c)] = weight;
  }
  return result;
}

// The changes d of the weights have the least sum of squares: d_c = (x_c - m).S^-1 e, with the corners x_c,
// their mean m, their scatter S = sum (x_c - m)(x_c - m)^T and the error e of the position. Their sum is
// zero.
void place_exactly(const Vector3& at_m, const std::vector<Vector3>& nodes, GridPoint& point) {
  const auto corner = [&](std::size_t c) { return nodes[static_cast<std::size_t>(point.node[c])]; };
  Vector3 mean = Vector3::Zero(), error = at_m;
  for (std::size_t c = 0; c < 8; ++c) {
    mean += corner(c) / 8.0;
    error -= point.weight[c] * corner(c);
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < 8; ++c) scatter += (corner(c) - mean) * (corner(c) - mean).transpose();
  const Vector3 slope = solve_symmetric(scatter, error);
  for (std::size_t c = 0; c < 8; ++c) point.weight[c] += slope.dot(corner(c) - mean);
}

std::size_t find_heaviest_node(const GridPoint& point) {
  const auto most = std::max_element(point.weight.begin(), point.weight.end()) - point.weight.begin();
  return static_cast<std::size_t>(point.node[static_cast<std::size_t>(most)]);
}

}  // namespace spoonbill
