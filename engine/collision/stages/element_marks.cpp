#include "engine/collision/stages/element_marks.h"

namespace spoonbill {

void ElementMarks::add_border(int i, int j, int rows_on, int columns_on, ContactStages& stages) const {
  const int columns = levels_.nested().grid.columns();
  for (int k = 0; k < levels_.step(0); ++k) {
    const int from = (i + k * rows_on) * columns + j + k * columns_on;
    keep(StageLine{levels_.sample(from), levels_.sample(from + rows_on * columns + columns_on)},
         stages.ranges, stages);
  }
}

void ElementMarks::add_to(ContactStages& stages) const {
  stages.elements += rows_ * columns_;
  const int stride = levels_.step(0);
  visit([&](const LevelCell& element) {
    ++stages.elements_within;
    const int row = element.i / stride, column = element.j / stride;
    if (!is_within(row - 1, column)) add_border(element.i, element.j, 0, 1, stages);
    if (!is_within(row + 1, column)) add_border(element.i + stride, element.j, 0, 1, stages);
    if (!is_within(row, column - 1)) add_border(element.i, element.j, 1, 0, stages);
    if (!is_within(row, column + 1)) add_border(element.i, element.j + stride, 1, 0, stages);
  });
}

}  // namespace spoonbill
