// The cells of one surface as slabs, taken as they are asked for.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/containers.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// One owner, one thread; allocates only when made.
class CellSlabs {
 public:
  explicit CellSlabs(SurfaceLevels& levels);

  // After SurfaceLevels::begin(): forgets the slabs of before.
  void begin();

  // A cell by its place in the tree of its element's cells.
  struct Place {
    LevelCell cell;
    int element_key, inside;
    int key() const { return element_key + inside; }
  };
  Place element(int element_u, int element_v) const {
    const int stride = levels_->step(0);
    return {{element_u * stride, element_v * stride, 0},
            (element_u * elements_v_ + element_v) * keys_an_element_,
            0};
  }
  // A cell of the next level, by its lane in within().
  Place finer(const Place& place, int lane) const {
    const int half = levels_->step(place.cell.level + 1);
    return {{place.cell.i + (lane >> 1) * half, place.cell.j + (lane & 1) * half, place.cell.level + 1},
            place.element_key,
            4 * place.inside + 1 + lane};
  }

  // The four cells of the next level within a cell that is not of the finest: lane 2 a + b is the half a
  // along u and b along v.
  const SlabGroup& within(const Place& place) {
    SlabGroup* group = nullptr;
    if (take_slot(place.key(), group)) take_within(place.cell, *group);
    return *group;
  }
  // The cell itself, in each lane. Both are valid until the next call.
  const SlabGroup& alone(const Place& place) {
    SlabGroup* group = nullptr;
    if (take_slot(keys_ + place.key(), group)) take_alone(place.cell, *group);
    return *group;
  }

 private:
  // False where the group is there already.
  bool take_slot(int key, SlabGroup*& group) {
    Slot& slot = slots_[key];
    const bool taken = slot.filling == filling_;
    if (!taken) {
      if (used_ == static_cast<int>(groups_.size())) begin();
      slot = {filling_, used_++};
    }
    group = &groups_[slot.group];
    return !taken;
  }
  void take_within(const LevelCell& cell, SlabGroup& group);
  void take_alone(const LevelCell& cell, SlabGroup& group);
  void take_samples(const LevelCell& cell, int stride);

  SurfaceLevels* levels_;
  AlignedVector<SlabGroup> groups_;
  struct Slot {
    std::uint32_t filling = 0;  // of groups_, at which the slot was taken
    int group = 0;
  };
  int elements_v_, keys_an_element_, keys_;
  std::vector<Slot> slots_;  // by key: the cells within a cell, then the cells alone
  std::uint32_t filling_ = 0;
  int used_ = 0;
  double samples_[3][9];  // working memory
};

}  // namespace spoonbill
