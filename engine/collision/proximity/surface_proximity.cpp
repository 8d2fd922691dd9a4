#include "engine/collision/proximity/surface_proximity.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

SurfaceProximity::SurfaceProximity(const NestedGrid& first, const NestedGrid& second)
    : first_(first), second_(second), cells_(first_.levels(), second_.levels()) {}

void SurfaceProximity::find(const Surface& first, const Surface& second, double margin_m,
                            double second_outside) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  SPOONBILL_ASSERT(std::abs(second_outside) == 1.0);
  if (first_.begin(first)) cells_.begin_first();
  if (second_.begin(second)) cells_.begin_second();
  cells_.update();
  missing_cells_ = false;
  const ElementTree &one = cells_.first_tree(), &other = cells_.second_tree();
  if (one.box(one.root()).gap(other.box(other.root())) > margin_m) return;
  for (const CellPair& pair : cells_.within(margin_m)) {
    first_.offer_corners(pair.first, second_.levels(), pair.second);
    second_.offer_corners(pair.second, first_.levels(), pair.first);
  }
  missing_cells_ = cells_.overflow();
  first_.settle(second_.levels(), second_outside, margin_m);
  second_.settle(first_.levels(), 1.0, margin_m);
  first_.add_between_samples(second_.levels(), second_outside);
  second_.add_between_samples(first_.levels(), 1.0);
}

double SurfaceProximity::least_gap_m() const {
  return std::min(first_.least_gap_m(), second_.least_gap_m());
}

}  // namespace spoonbill
