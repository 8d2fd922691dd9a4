// Places of a region of contact: the middles of its pairs of cells, what they cover, and where one surface is
// deepest behind the other.
#pragma once

#include <span>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/levels/parameter_range.h"
#include "engine/collision/surfaces/contact_regions.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// The pairs of one region, and the levels of the surfaces of their cells, which may be the same. A view for
// the length of a call. Allocates nothing.
struct RegionCells {
  const SurfaceLevels* first;
  const SurfaceLevels* second;
  std::span<const CellPair> pairs;

  PairParameters middle_of(const CellPair& pair) const;
  // One of `count` pairs spread evenly over the region, or one for each pair where they are fewer.
  PairParameters middle_of(std::size_t which, std::size_t count) const {
    return middle_of(pairs[which * pairs.size() / count]);
  }
  std::size_t at_most(std::size_t count) const { return count < pairs.size() ? count : pairs.size(); }
};

RegionCells cells_of(const SurfaceLevels& first, const SurfaceLevels& second,
                     const std::vector<CellPair>& pairs, const ContactRegions::Region& region);

struct RegionRanges {
  ParameterRange first, second;
};
RegionRanges ranges_of(const RegionCells& cells);

// Of a few of the pairs and a point of touch, the one where the first surface is deepest behind the second.
// See deepest_pair() for `outside`.
PairParameters deepest_place(const RegionCells& cells, const PairParameters& touch, double outside);

// On which side of one's surface another lies whose outward normal there is `normal`: 1 where they face each
// other, -1 where they face one way; `own` is one's own du x dv there.
double side_facing(const Vector3& normal, const Vector3& own);

}  // namespace spoonbill
