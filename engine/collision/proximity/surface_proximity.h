// Where two closed surfaces come near each other: samples of either with the other's nearest points, and the
// places between samples where they are nearest or deepest.
#pragma once

#include <vector>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/proximity/near_points.h"

namespace spoonbill {

// One owner, one thread; allocates only when made. The grids must outlive it.
class SurfaceProximity {
 public:
  SurfaceProximity(const NestedGrid& first, const NestedGrid& second);
  SurfaceProximity(const SurfaceProximity&) = delete;
  SurfaceProximity& operator=(const SurfaceProximity&) = delete;

  // All that is within `margin_m`. The surfaces must have the grids' knots and bound bodies: du x dv points
  // outwards, or inwards of the second where `second_outside` is -1, as of a mirrored surface.
  void find(const Surface& first, const Surface& second, double margin_m, double second_outside = 1.0);

  // Keeps those of the points of either that `keep_first` and `keep_second` keep, as they leave them.
  template <class KeepFirst, class KeepSecond>
  void keep_if(const KeepFirst& keep_first, const KeepSecond& keep_second) {
    first_.keep_if(keep_first);
    second_.keep_if(keep_second);
  }

  // Of the last find(): the points of one surface.
  const std::vector<NearPoint>& of_first() const { return first_.points(); }
  const std::vector<NearPoint>& of_second() const { return second_.points(); }
  double least_gap_m() const;  // infinite where nothing is near
  // A capacity was met, and points may be missing. Remedy: fewer control points or a smaller margin.
  bool overflow() const { return missing_cells_ || first_.overflow() || second_.overflow(); }

 private:
  NearPoints first_, second_;
  CellPairs cells_;
  bool missing_cells_ = false;
};

}  // namespace spoonbill
