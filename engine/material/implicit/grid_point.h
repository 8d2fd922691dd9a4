// A node of one grid over a body as a weighted sum of the nodes of another grid over the same body. Plain
// data.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

struct GridPoint {
  std::array<int, 8> node{};
  std::array<double, 8> weight{};

  template <class Of>
  Vector3 sum_over(const Of& of) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) sum += weight[c] * of(node[c]);
    return sum;
  }
  // Distributes a vector at the point among the nodes and adds it to their values, by coordinate.
  void spread(const Vector3& point_value, std::vector<double>& by_coordinate) const {
    for (std::size_t c = 0; c < 8; ++c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        by_coordinate[3 * static_cast<std::size_t>(node[c]) + axis] +=
            weight[c] * point_value[static_cast<Eigen::Index>(axis)];
      }
    }
  }
};

// Returns a node of one grid as a weighted sum of the nodes of another, trilinear in the grid indices. The
// weights are not negative.
GridPoint embed_node(const LatticeMesh& of, int node, const LatticeMesh& by);

// Changes the weights so that they give the position `at_m` of the point, and not the nearby one at its grid
// indices: inside a bent body the cells of the two grids are not congruent. Otherwise the point would keep
// its distance from the body's material in space while the body rotates, and forces on it would have a wrong
// moment. Weights may become negative. `nodes` are the positions to which the node numbers refer.
void place_exactly(const Vector3& at_m, const std::vector<Vector3>& nodes, GridPoint& point);

// Returns the number of the node with the largest weight.
std::size_t find_heaviest_node(const GridPoint& point);

}  // namespace spoonbill
