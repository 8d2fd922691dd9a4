#include "engine/collision/surfaces/region_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr std::size_t depth_seeds = 8;

// Of the finest samples, around cells.
struct SampleRange {
  int i0 = std::numeric_limits<int>::max(), i1 = 0, j0 = std::numeric_limits<int>::max(), j1 = 0;
  void widen(const LevelCell& cell, int step) {
    i0 = std::min(i0, cell.i);
    i1 = std::max(i1, cell.i + step);
    j0 = std::min(j0, cell.j);
    j1 = std::max(j1, cell.j + step);
  }
  ParameterRange of(const Grid& grid) const {
    return {grid.u.parameters[i0], grid.u.parameters[i1], grid.v.parameters[j0], grid.v.parameters[j1]};
  }
};

double middle(const std::vector<double>& parameters, int at, int step) {
  return 0.5 * (parameters[at] + parameters[at + step]);
}

}  // namespace

PairParameters RegionCells::middle_of(const CellPair& pair) const {
  const Grid& a = first->nested().grid;
  const Grid& b = second->nested().grid;
  const int step_a = first->step(pair.first.level), step_b = second->step(pair.second.level);
  return {middle(a.u.parameters, pair.first.i, step_a), middle(a.v.parameters, pair.first.j, step_a),
          middle(b.u.parameters, pair.second.i, step_b), middle(b.v.parameters, pair.second.j, step_b)};
}

RegionCells cells_of(const SurfaceLevels& first, const SurfaceLevels& second,
                     const std::vector<CellPair>& pairs, const ContactRegions::Region& region) {
  SPOONBILL_ASSERT(region.begin < region.end && region.end <= pairs.size());
  return {&first, &second, std::span(pairs).subspan(region.begin, region.end - region.begin)};
}

RegionRanges ranges_of(const RegionCells& cells) {
  SPOONBILL_ASSERT(!cells.pairs.empty());
  SampleRange first, second;
  for (const CellPair& pair : cells.pairs) {
    first.widen(pair.first, cells.first->step(pair.first.level));
    second.widen(pair.second, cells.second->step(pair.second.level));
  }
  return {first.of(cells.first->nested().grid), second.of(cells.second->nested().grid)};
}

PairParameters deepest_place(const RegionCells& cells, const PairParameters& touch, double outside) {
  SPOONBILL_ASSERT(std::abs(outside) == 1.0);
  const std::size_t seeds = cells.at_most(depth_seeds);
  PairParameters deepest = touch;
  double depth = 0.0;
  for (std::size_t k = 0; k < seeds; ++k) {
    const PairParameters at = cells.middle_of(k, seeds);
    const double here = depth_behind(cells.first->pieces(), cells.second->pieces(), at, outside);
    if (!(here > depth)) continue;
    depth = here;
    deepest = at;
  }
  return deepest;
}

double side_facing(const Vector3& normal, const Vector3& own) {
  return normal.dot(own) < 0.0 ? 1.0 : -1.0;
}

}  // namespace spoonbill
