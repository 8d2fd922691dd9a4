// Groups pairs of cells into connected regions, and selects starting parameters within a region.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// Groups connected pairs of cells by union-find. Not thread-safe. Allocates only on construction.
class ContactRegions {
 public:
  ContactRegions(const SurfaceLevels& first, const SurfaceLevels& second);

  struct Region {
    std::size_t begin, end;  // range of the region's pairs, which are consecutive
  };

  // Sorts the pairs by region and returns the regions. Two pairs are connected if their cells are equal or
  // neighbours on both surfaces, also across a seam. Regions beyond the capacity are merged into the last
  // region.
  const std::vector<Region>& group(std::vector<CellPair>& pairs);

 private:
  // Returns true if two cells of the second surface are equal or have a corner in common.
  bool are_neighbours(const LevelCell& a, const LevelCell& b, int step) const {
    const int in_u = std::abs(a.i - b.i), in_v = std::abs(a.j - b.j);
    return (in_u <= step || around_u_ - in_u <= step) && (in_v <= step || around_v_ - in_v <= step);
  }
  // A cell of the first surface that belongs to at least one pair.
  struct Paired {
    std::uint32_t at = 0;  // serial number of the last group() call in which the cell was in a pair
    int last_pair = 0;
    bool split = false;  // true if the cell's pairs are not all connected
  };

  int root(int pair);
  void collect_cells(const std::vector<CellPair>& pairs);
  void join_neighbours(const std::vector<CellPair>& pairs, int pair);
  void join(const std::vector<CellPair>& pairs, const Paired& cell, const Paired& other);
  void order_by_region(std::vector<CellPair>& pairs);

  const SurfaceLevels* first_;
  const SurfaceLevels* second_;
  // Number of the second surface's cells around each periodic direction; unlimited for an open direction.
  int around_u_ = 0, around_v_ = 0;
  std::vector<int> parent_;     // union-find parent of each pair, which is an earlier pair or itself
  std::vector<int> previous_;   // for each pair, the previous pair with the same first cell; -1 for the first
  std::vector<int> cell_;       // for each pair, the cell_index() of its first cell
  std::vector<Paired> paired_;  // indexed by cell_index()
  std::uint32_t group_ = 0;
  std::vector<Region> regions_;
  // Working memory: for each region, the position at which its next pair is stored.
  std::vector<int> end_;
  std::vector<CellPair> unordered_;  // working memory: copy of the pairs before they are sorted
};

// Mean of parameters of one direction. In a periodic direction, each parameter is first moved by whole
// periods to be as near as possible to the first one.
class ParameterMean {
 public:
  explicit ParameterMean(const KnotVector& knots) : knots_(&knots) {}
  void add(double parameter) {
    if (count_ == 0) first_ = parameter;
    const double length = knots_->domain_length();
    double difference = parameter - first_;
    if (knots_->is_periodic()) difference -= length * std::round(difference / length);
    sum_ += difference;
    ++count_;
  }
  // Returns the mean. At least one parameter must have been added.
  double mean() const {
    SPOONBILL_ASSERT(count_ > 0);
    return knots_->into_domain(first_ + sum_ / count_);
  }
  // Returns the parameter at a fraction of the path from the mean to another parameter. A fraction above 1
  // extrapolates.
  double towards(double parameter, double fraction) const {
    const double from = first_ + sum_ / count_, length = knots_->domain_length();
    double difference = parameter - from;
    if (knots_->is_periodic()) difference -= length * std::round(difference / length);
    return knots_->into_domain(from + fraction * difference);
  }

 private:
  const KnotVector* knots_;
  double first_ = 0.0, sum_ = 0.0;
  int count_ = 0;
};

// Mean of the parameters of pairs, which serves as the centre of a contact region on both surfaces.
class RegionCentre {
 public:
  RegionCentre(const Surface& first, const Surface& second)
      : u_(first.u), v_(first.v), s_(second.u), t_(second.v) {}
  void add(const PairParameters& at) {
    u_.add(at.u);
    v_.add(at.v);
    s_.add(at.s);
    t_.add(at.t);
  }
  PairParameters mean() const { return {u_.mean(), v_.mean(), s_.mean(), t_.mean()}; }
  PairParameters towards(const PairParameters& at, double fraction) const {
    return {u_.towards(at.u, fraction), v_.towards(at.v, fraction), s_.towards(at.s, fraction),
            t_.towards(at.t, fraction)};
  }

 private:
  ParameterMean u_, v_, s_, t_;
};

// The pairs of cells of one region, and the levels of both surfaces, which may be the same surface. The
// object refers to the pairs and is valid as long as they are. Allocates nothing.
struct RegionCells {
  const SurfaceLevels* first;
  const SurfaceLevels* second;
  std::span<const CellPair> pairs;

  PairParameters pair_centre(const CellPair& pair) const;
  // Returns the centre of pair `which` of `count` pairs that are spread evenly over the region. `which` must
  // be below `count`, and `count` at most the number of pairs.
  PairParameters pair_centre(std::size_t which, std::size_t count) const {
    return pair_centre(pairs[which * pairs.size() / count]);
  }
  std::size_t at_most(std::size_t count) const { return count < pairs.size() ? count : pairs.size(); }
};

RegionCells region_cells(const SurfaceLevels& first, const SurfaceLevels& second,
                         const std::vector<CellPair>& pairs, const ContactRegions::Region& region);

// Parameter rectangles that contain a region, one on each surface.
struct RegionRanges {
  ParameterRange first, second;
};
RegionRanges region_ranges(const RegionCells& cells);

// Compares the centres of a few pairs of cells of the region, and returns the one at which the first surface
// is deepest behind the second. Returns `touch` if the first surface is not behind the second at any of them.
// `outside` is 1 if the second surface's outward normal is du x dv, -1 if it is opposite.
PairParameters find_deepest_seed(const RegionCells& cells, const PairParameters& touch, double outside);

// Returns the side of a surface that faces another surface: 1 for the side of du x dv, -1 for the opposite
// side. `normal` is the other surface's outward normal; `own` is the du x dv of the surface itself.
double facing_side(const Vector3& normal, const Vector3& own);

}  // namespace spoonbill
