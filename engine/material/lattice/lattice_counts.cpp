#include "engine/material/lattice/lattice_counts.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace spoonbill {
namespace {

using Counts = std::array<int, 3>;

Counts near_cubic_counts(const Vector3& size, int budget, const Counts& least_cells) {
  double edge = std::cbrt(size.x() * size.y() * size.z() / budget);
  for (;; edge *= 1.01) {
    // More than the budget in one direction is too many, however many more.
    const auto count = [&](int axis) {
      const double cells = std::min(size[axis] / edge, 1.0 * budget);
      return std::max(least_cells[static_cast<std::size_t>(axis)], static_cast<int>(std::lround(cells))) + 1;
    };
    const Counts counts = {count(0), count(1), count(2)};
    const double nodes = 1.0 * counts[0] * counts[1] * counts[2];
    const bool least = counts == Counts{least_cells[0] + 1, least_cells[1] + 1, least_cells[2] + 1};
    if (nodes <= budget || least) return counts;
  }
}

Result<Counts> given_or(const LatticeRequest& request, const Vector3& size_m, const Counts& least_cells) {
  const Counts counts =
      request.counts ? *request.counts : near_cubic_counts(size_m, request.node_budget, least_cells);
  for (const int count : counts) {
    if (count < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  return counts;
}

}  // namespace

Result<std::array<int, 3>> lattice_counts(const LatticeRequest& request, const Vector3& size_m) {
  return given_or(request, size_m, {2, 2, 2});
}

Result<std::array<int, 3>> shell_counts(const LatticeRequest& request, const Vector3& size_m, bool closed) {
  constexpr int round_enough = 8;
  Result<Counts> counts = given_or(request, size_m, {closed ? round_enough : 2, 1, 2});
  if (counts.ok() && closed && counts.value()[0] <= least_cells_around) {
    return Error{"lattice: nodes[0] is " + std::to_string(counts.value()[0]) + ", must be at least " +
                 std::to_string(least_cells_around + 1) + " around a shell that closes"};
  }
  return counts;
}

}  // namespace spoonbill
