// What differs between two shapes, kept bit for bit: the unit of undo. Memory follows what a stroke changed,
// not the size of the body. Plain value, one owner.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/simulation/simulation.h"

namespace spoonbill {

struct ChangedNumber {
  std::uint32_t index;  // into ShapeState::lattice
  float before;
  float after;
};

using ShapeDifference = std::vector<ChangedNumber>;

// Both shapes must be of one size. Numbers differ when their bits do.
ShapeDifference difference(const ShapeState& before, const ShapeState& after);

// `shape` must be the `after`, or the `before`, of the difference; it becomes the other one.
void take_back(ShapeState& shape, const ShapeDifference& change);
void do_again(ShapeState& shape, const ShapeDifference& change);

}  // namespace spoonbill
