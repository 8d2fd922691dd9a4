#include "app/undo/shape_difference.h"

#include <bit>

namespace spoonbill {
namespace {

std::uint32_t bits_of(float number) {
  return std::bit_cast<std::uint32_t>(number);
}

}  // namespace

ShapeDifference difference(const ShapeState& before, const ShapeState& after) {
  ShapeDifference changes;
  for (std::size_t i = 0; i < before.lattice.size(); ++i) {
    if (bits_of(before.lattice[i]) == bits_of(after.lattice[i])) continue;
    changes.push_back({static_cast<std::uint32_t>(i), before.lattice[i], after.lattice[i]});
  }
  changes.shrink_to_fit();
  return changes;
}

void take_back(ShapeState& shape, const ShapeDifference& change) {
  for (const ChangedNumber& number : change) shape.lattice[number.index] = number.before;
}

void do_again(ShapeState& shape, const ShapeDifference& change) {
  for (const ChangedNumber& number : change) shape.lattice[number.index] = number.after;
}

}  // namespace spoonbill
