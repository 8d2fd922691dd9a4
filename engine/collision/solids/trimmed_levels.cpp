#include "engine/collision/solids/trimmed_levels.h"

#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

TrimmedLevels::TrimmedLevels(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> area)
    : levels_(nested.levels),
      columns_(nested.grid.columns() - 1),
      area_(std::move(area)),
      cells_(GridLines(nested.grid.u), GridLines(nested.grid.v), *area_) {
  const Grid& grid = nested.grid;
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) kept_samples_.push_back(contains(u, v) ? 1 : 0);
  }
  const int rows = grid.rows() - 1, width = columns_ + 1;
  present_.assign(static_cast<std::size_t>(rows + 1) * static_cast<std::size_t>(width), 0);
  const auto at = [&](int i, int j) -> int& { return present_[static_cast<std::size_t>(i * width + j)]; };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns_; ++j) {
      const int here = cells_.state(i, j) != TrimmedCells::State::away ? 1 : 0;
      at(i + 1, j + 1) = at(i, j + 1) + at(i + 1, j) - at(i, j) + here;
    }
  }
}

bool TrimmedLevels::is_away(const LevelCell& cell) const {
  SPOONBILL_ASSERT_DEBUG(cell.level >= 0 && cell.level <= levels_);
  const int step = 1 << (levels_ - cell.level), width = columns_ + 1;
  const auto at = [&](int i, int j) { return present_[static_cast<std::size_t>(i * width + j)]; };
  return at(cell.i + step, cell.j + step) - at(cell.i, cell.j + step) - at(cell.i + step, cell.j) +
             at(cell.i, cell.j) ==
         0;
}

}  // namespace spoonbill
