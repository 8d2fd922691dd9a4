// The cells of one surface as slabs, taken as they are asked for.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/aligned_vector.h"
#include "engine/collision/surface_levels.h"

namespace spoonbill {

// One owner, one thread; allocates only when made.
class CellSlabs {
 public:
  explicit CellSlabs(SurfaceLevels& levels);

  // After SurfaceLevels::begin(): forgets the slabs of before.
  void begin();

  // The four cells of the next level within a cell that is not of the finest: lane 2 a + b is the half a
  // along u and b along v.
  const SlabGroup& within(const LevelCell& cell);
  // The cell itself, in each lane. Both are valid until the next call.
  const SlabGroup& alone(const LevelCell& cell);

 private:
  // False where the group is there already.
  bool take_slot(int key, SlabGroup*& group);
  void take_samples(const LevelCell& cell, int stride);

  SurfaceLevels* levels_;
  AlignedVector<SlabGroup> groups_;
  std::vector<int> slot_;                // by key: the cells within a cell, then the cells alone
  std::vector<std::uint32_t> taken_at_;  // by key: the filling of groups_
  std::uint32_t filling_ = 0;
  int used_ = 0;
  double samples_[3][9];  // working memory
};

}  // namespace spoonbill
