#include "engine/material/lattice/lattice_request.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

std::array<int, 3> near_cubic_counts(const Vector3& size, int budget) {
  double edge = std::cbrt(size.x() * size.y() * size.z() / budget);
  for (;; edge *= 1.01) {
    // More than the budget in one direction is too many, however many more.
    const auto count = [&](double length) {
      return std::max(2, static_cast<int>(std::lround(std::min(length / edge, 1.0 * budget)))) + 1;
    };
    const std::array<int, 3> counts = {count(size.x()), count(size.y()), count(size.z())};
    const double nodes = 1.0 * counts[0] * counts[1] * counts[2];
    if (nodes <= budget || counts[0] + counts[1] + counts[2] == 9) return counts;
  }
}

}  // namespace

Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m) {
  const std::array<int, 3> counts =
      request.counts ? *request.counts : near_cubic_counts(size_m, request.node_budget);
  for (const int count : counts) {
    if (count < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  return counts;
}

}  // namespace spoonbill
