// The points of one surface that come near a surface: samples with the other's nearest points, and the places
// between samples where it is nearest or deepest.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/collision/levels/surface_levels.h"

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

// Called in the order of its functions. One owner, one thread; allocates only when made. The grid must
// outlive it.
class NearPoints {
 public:
  explicit NearPoints(const NestedGrid& nested);

  // Forgets the points of before. False where the surface has not moved since the last time.
  bool begin(const Surface& surface);

  // The corners of a cell against a cell of the other surface, which may be this one.
  void offer_corners(const LevelCell& cell, SurfaceLevels& other, const LevelCell& patch);
  // One sample, (i, j) of the finest grid, against a cell of the given corners.
  void offer(int i, int j, const SurfaceLevels& other, const LevelCell& patch, const PatchCorners& corners);
  // The least distance of a sample to what it was offered, by the triangles of corners; infinite before.
  double offered_m(int sample) const;
  // Each sample against the other surface's point nearest to it; those that are not within the margin after
  // all go. `outside` is -1 where the other's du x dv points inwards.
  void settle(const SurfaceLevels& other, double outside, double margin_m);
  // Between its samples a surface may be nearer than at any.
  void add_between_samples(const SurfaceLevels& other, double outside);

  // Keeps the points for which keep(point) holds, as it leaves them.
  template <class Keep>
  void keep_if(const Keep& keep) {
    std::size_t kept = 0;
    least_gap_m_ = std::numeric_limits<double>::infinity();
    for (NearPoint& near : near_) {
      if (!keep(near)) {
        if (near.sample >= 0) placed_at_[near.sample] = 0;
        continue;
      }
      least_gap_m_ = near.gap_m < least_gap_m_ ? near.gap_m : least_gap_m_;
      if (near.sample >= 0) place_[near.sample] = static_cast<int>(kept);
      near_[kept++] = near;
    }
    near_.resize(kept);
  }

  SurfaceLevels& levels() { return levels_; }
  const SurfaceLevels& levels() const { return levels_; }
  const std::vector<NearPoint>& points() const { return near_; }
  double least_gap_m() const { return least_gap_m_; }  // infinite where nothing is near
  // A capacity was met, and points may be missing.
  bool overflow() const { return overflow_; }

 private:
  bool is_local_deepest(const NearPoint& near) const;

  SurfaceLevels levels_;
  std::vector<int> place_;                // of each sample in `near_`
  std::vector<std::uint32_t> placed_at_;  // the begin() since which that is so
  std::vector<NearPoint> near_;
  std::uint32_t begun_ = 0;
  double least_gap_m_ = 0.0;
  bool overflow_ = false;
};

}  // namespace spoonbill
