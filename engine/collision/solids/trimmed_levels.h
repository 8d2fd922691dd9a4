// What a trimmed area keeps of the cells and samples of a nested grid, so that a search passes over the rest.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Immutable once made: asking allocates nothing.
class TrimmedLevels {
 public:
  TrimmedLevels(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> area);

  bool contains(double u, double v) const { return area_->contains(u, v); }
  bool keeps_sample(int index) const { return kept_samples_[static_cast<std::size_t>(index)] != 0; }

  // Of any level: nothing of it is kept.
  bool is_away(const LevelCell& cell) const;
  // Of the finest level: loops cross it.
  bool is_cut(const LevelCell& cell) const {
    return cells_.state(cell.i, cell.j) == TrimmedCells::State::cut;
  }
  std::span<const TrimmedArea::Edge> rim(const LevelCell& cell) const { return cells_.edges(cell.i, cell.j); }

 private:
  int levels_;
  int columns_;  // of finest cells
  std::shared_ptr<const TrimmedArea> area_;
  TrimmedCells cells_;
  std::vector<std::uint8_t> kept_samples_;
  std::vector<int> present_;  // finest cells that are not away, in the rows and columns before each
};

}  // namespace spoonbill
