// The elements of one surface that the limits of the parameters leave.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/stages/contact_stages.h"

namespace spoonbill {

// One owner, one thread; after SurfaceLevels::begin(), of levels that outlive it.
class ElementMarks {
 public:
  explicit ElementMarks(SurfaceLevels& levels)
      : levels_(levels),
        rows_((levels.nested().grid.rows() - 1) / levels.step(0)),
        columns_((levels.nested().grid.columns() - 1) / levels.step(0)),
        within_(static_cast<std::size_t>(rows_ * columns_), 0) {}

  void mark(const LevelCell& element) {
    within_[static_cast<std::size_t>(element.i / levels_.step(0) * columns_ + element.j / levels_.step(0))] =
        1;
  }
  template <class Visit>
  void visit(const Visit& visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (is_within(row, column)) visit(LevelCell{row * levels_.step(0), column * levels_.step(0), 0});
      }
    }
  }
  void add_to(ContactStages& stages) const;

 private:
  bool is_within(int row, int column) const {
    const Grid& grid = levels_.nested().grid;
    if (grid.u.knots.is_periodic()) row = (row + rows_) % rows_;
    if (grid.v.knots.is_periodic()) column = (column + columns_) % columns_;
    if (row < 0 || row >= rows_ || column < 0 || column >= columns_) return false;
    return within_[static_cast<std::size_t>(row * columns_ + column)] != 0;
  }
  // Along the samples from (i, j), each that many rows and columns on.
  void add_border(int i, int j, int rows_on, int columns_on, ContactStages& stages) const;

  SurfaceLevels& levels_;
  int rows_, columns_;
  std::vector<std::uint8_t> within_;
};

}  // namespace spoonbill
