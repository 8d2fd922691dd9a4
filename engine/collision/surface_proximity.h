// Where two closed surfaces come near each other: samples of either with the other's nearest points, and the
// places between samples where they are nearest or deepest.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/cell_pairs.h"
#include "engine/collision/pair_polish.h"
#include "engine/collision/surface_levels.h"

namespace spoonbill {

// A point of one surface and what it is near to of the other.
struct NearPoint {
  int sample = -1;          // into the grid of its surface; -1 between samples
  double u = 0.0, v = 0.0;  // on its surface
  double other_u = 0.0, other_v = 0.0;
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitY();  // unit, of the other surface, outwards
  double gap_m = 0.0;                 // along it; below zero, how deep the point is in the other body
};

// One owner, one thread; allocates only when made. The grids must outlive it.
class SurfaceProximity {
 public:
  SurfaceProximity(const NestedGrid& first, const NestedGrid& second);
  SurfaceProximity(const SurfaceProximity&) = delete;
  SurfaceProximity& operator=(const SurfaceProximity&) = delete;

  // All that is within `margin_m`. The surfaces must have the grids' knots and bound bodies: du x dv points
  // outwards, or inwards of the second where `second_outside` is -1, as of a mirrored surface.
  void find(const Surface& first, const Surface& second, double margin_m, double second_outside = 1.0);

  // Of the last find(): the points of one surface.
  const std::vector<NearPoint>& of_first() const { return first_.near; }
  const std::vector<NearPoint>& of_second() const { return second_.near; }
  double least_gap_m() const { return least_gap_m_; }  // infinite where nothing is near
  // A capacity was met, and points may be missing. Remedy: fewer control points or a smaller margin.
  bool overflow() const { return overflow_; }

 private:
  struct Side {
    explicit Side(const NestedGrid& nested);
    SurfaceLevels levels;
    std::vector<int> place;                // of each sample in `near`
    std::vector<std::uint32_t> placed_at;  // the find() in which that was so
    std::vector<NearPoint> near;
  };
  void offer_corners(Side& side, const LevelCell& cell, Side& other, const LevelCell& patch);
  void settle(Side& side, const SurfaceLevels& other, double outside, double margin);
  void add_between_samples(Side& side, const SurfaceLevels& other, double outside);
  bool is_local_deepest(const Side& side, const NearPoint& near) const;

  Side first_, second_;
  CellPairs cells_;
  std::uint32_t search_ = 0;
  double least_gap_m_ = 0.0;
  bool overflow_ = false;
};

}  // namespace spoonbill
