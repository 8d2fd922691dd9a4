// Where a node of one grid lies in another.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// A node of one grid as a weighted sum of another's.
struct GridPoint {
  std::array<int, 8> node{};
  std::array<double, 8> weight{};

  template <class Of>
  Vector3 sum_over(const Of& of) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) sum += weight[c] * of(node[c]);
    return sum;
  }
  // Adds to what the nodes have, by coordinate.
  void share_out(const Vector3& of_point, std::vector<double>& by_coordinate) const {
    for (std::size_t c = 0; c < 8; ++c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        by_coordinate[3 * static_cast<std::size_t>(node[c]) + axis] +=
            weight[c] * of_point[static_cast<Eigen::Index>(axis)];
      }
    }
  }
};

}  // namespace spoonbill
