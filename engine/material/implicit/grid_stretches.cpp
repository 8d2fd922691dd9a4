#include "engine/material/implicit/grid_stretches.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {

std::vector<Stretch> stretches(int block_cell, int block_count, int lattice_count) {
  SPOONBILL_ASSERT(block_count >= 2 && lattice_count >= 2);
  SPOONBILL_ASSERT(block_cell >= 0 && block_cell < block_count - 1);
  // Less of a cell than this is rounding.
  constexpr double least = 1e-9;
  std::vector<Stretch> result;
  const double scale = static_cast<double>(block_count - 1) / (lattice_count - 1);
  for (int cell = 0; cell + 1 < lattice_count; ++cell) {
    const double low = std::max(2.0 * (cell * scale - block_cell) - 1.0, -1.0);
    const double high = std::min(2.0 * ((cell + 1) * scale - block_cell) - 1.0, 1.0);
    if (high - low > least) result.push_back({cell, low, high});
  }
  return result;
}

}  // namespace spoonbill
