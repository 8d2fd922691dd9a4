#include "engine/collision/levels/cell_slabs.h"

#include <algorithm>

namespace spoonbill {
namespace {

// Where more are asked for, those of before are taken again.
constexpr int group_capacity = 8192;
// Cells of one element are as large but for the rounding of their parameters.
constexpr double same_size = 1.0 + 1e-9;

}  // namespace

CellSlabs::CellSlabs(SurfaceLevels& levels)
    : levels_(&levels),
      elements_v_(levels.bounds().elements_v()),
      keys_an_element_(((4 << (2 * levels.nested().levels)) - 1) / 3),
      keys_(keys_an_element_ * levels.cell_count(0)) {
  groups_.resize(static_cast<std::size_t>(std::min(2 * keys_, group_capacity)));
  slots_.resize(static_cast<std::size_t>(2 * keys_));
  begin();
}

void CellSlabs::begin() {
  ++filling_;
  used_ = 0;
}

// 3 x 3 samples from the cell's low corner on.
void CellSlabs::take_samples(const LevelCell& cell, int stride) {
  levels_->sample_element(cell.i >> levels_->nested().levels, cell.j >> levels_->nested().levels);
  const PlanarPoints from = levels_->samples();
  const int columns = levels_->nested().grid.columns();
  const double* const values[3] = {from.x, from.y, from.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double* row = values[axis] + cell.i * columns + cell.j;
    for (int a = 0; a < 3; ++a, row += stride * columns) {
      for (int b = 0; b < 3; ++b) samples_[axis][3 * a + b] = row[b * stride];
    }
  }
}

void CellSlabs::take_within(const LevelCell& cell, SlabGroup& group) {
  take_samples(cell, levels_->step(cell.level + 1));
  // Both sides are halved, and it goes by their squares.
  const double bulge = 0.25 * same_size * levels_->bulge(cell);
  levels_->kernels().take_slabs({samples_[0], samples_[1], samples_[2]}, bulge, group);
}

void CellSlabs::take_alone(const LevelCell& cell, SlabGroup& group) {
  // The same four corners for each of the lanes.
  const PatchCorners corners = levels_->corners(cell);
  constexpr int corner_of[9] = {0, 1, 0, 2, 3, 2, 0, 1, 0};
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 9; ++k) samples_[axis][k] = corners[corner_of[k]][axis];
  }
  levels_->kernels().take_slabs({samples_[0], samples_[1], samples_[2]}, levels_->bulge(cell), group);
}

}  // namespace spoonbill
