// Search for parts of one body's surface that are near each other across the space outside the body. It finds
// samples with the nearest points of other parts, and the locally nearest or deepest points between samples.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/proximity/surface_proximity.h"

namespace spoonbill {

// Distance along the surface at rest below which two points are neighbours, which cannot touch. It is the
// larger of two lengths: a number of lattice cells, and a number of thicknesses of the body (twice its volume
// divided by its area). If a bar is bent into a loop whose inner side touches itself, the two touching points
// are farther apart along the loop than 4.4 times the bending radius. Three thicknesses are less than that if
// the bending radius is above about two thirds of the thickness. Contact in tighter loops may not be found.
inline constexpr double neighbour_cells = 4.0;
inline constexpr double neighbour_thicknesses = 3.0;

// Distance between two points up to which they count as points of opposite sides if they face each other
// through the body. Such points never meet. Points farther apart, such as those at the ends of a bar, may
// meet. The distance is given as a multiple of the distance below which points are neighbours.
inline constexpr double through_body = 2.0;

// Decides which pairs of points of one body's surface can ever touch from outside, by the positions of the
// points at rest. All other pairs are neighbours or face each other through the body. Immutable, so any
// thread may use it.
class RestPairs {
 public:
  // `rest` is the surface at rest, with the knots of the grid and with du x dv pointing outward. `cell_m` is
  // the size of the lattice's cells.
  RestPairs(const Grid& grid, Surface rest, double cell_m);

  // Returns true if two points can touch. They are samples of the grid, or points given by their parameters.
  bool can_meet(int sample, int other) const { return can_meet(points_[sample], points_[other]); }
  bool can_meet(double u, double v, double other_u, double other_v) const;

 private:
  struct RestPoint {
    Vector3 position_m, normal;
    int block;
  };
  RestPoint point_at(double u, double v) const;
  bool can_meet(const RestPoint& one, const RestPoint& other) const;
  double thickness(int columns) const;
  void find_neighbours();
  void measure_from(int block, std::vector<double>& distances) const;
  double step_between(int block, int other) const;

  Surface rest_;
  std::vector<double> u_,
      v_;  // starts of the blocks of the surface in u and in v, and the end of the last block
  double cell_m_, neighbour_distance_m_ = 0.0;
  std::vector<RestPoint> points_;       // one for each sample
  std::vector<Vector3> block_centres_;  // one for each block
  // For each pair of blocks, true if they are near each other along the surface.
  std::vector<bool> neighbours_;
};

// Finds pairs of rings of a surface that may be near each other. A ring consists of the elements between two
// neighbouring knots of v. Tests the boxes of the rings, then the intervals that they occupy along each
// ring's axis. For a long body that is not folded, all pairs are ruled out in a few microseconds. Not
// thread-safe. Allocates only on construction.
class RingSeparation {
 public:
  // `pairs` lists the pairs of rings to be tested. A ring is given by the index of its elements along v.
  RingSeparation(const KnotVector& v, std::vector<std::array<int, 2>> pairs);

  // Returns the pairs of rings for which no separating plane with a gap above `reach_m` was found. Updates
  // the boxes of `bounds`, which must have the net's knots.
  const std::vector<std::array<int, 2>>& find_near(const ControlNet& net, SurfaceBounds& bounds,
                                                   double reach_m);

 private:
  struct Interval {
    double low, high;
  };
  void compute_centres(const ControlNet& net);
  void compute_intervals(const ControlNet& net, int ring);
  Interval interval(int ring, int along) const;
  bool are_apart_along(const ControlNet& net, int axis_ring, int other, double reach_m);

  int columns_;              // number of columns of control points in the net
  int width_;                // number of those that affect a ring, which is the elements of one span of v
  std::vector<int> column_;  // indices of the control columns of each ring, width_ per ring
  std::vector<std::array<int, 2>> pairs_, near_;
  std::vector<Vector3> centres_;    // sum of the points of each control column
  std::vector<double> low_, high_;  // for each control column, its interval along the axis of each ring
  std::vector<Box> boxes_;          // one for each ring
  std::vector<char> is_current_;    // for each ring, true if its intervals are up to date
};

// Largest depth, in lattice cells, of a point of the surface inside another part of the body. Deeper points
// are ignored, because the point nearest to such a point may be on another wall.
inline constexpr double deepest_self_cells = 1.0;

// Self-proximity search of one surface. Not thread-safe. Allocates only on construction. The grid must
// outlive the search.
class SelfProximity {
 public:
  // `rest` bounds a body, with du x dv pointing outward. `cell_m` is the size of the cells of the body's
  // lattice.
  SelfProximity(const NestedGrid& nested, const Surface& rest, double cell_m);
  SelfProximity(const SelfProximity&) = delete;
  SelfProximity& operator=(const SelfProximity&) = delete;

  // Finds all points that face another part within `margin_m` and can touch it (see RestPairs). The margin
  // must be the same in each call. A call takes almost no time while the body is not folded.
  void find(const Surface& surface, double margin_m);

  // Takes over what `before` knows about a surface of the same shape with fewer knots, so that the next
  // find() need not search where that of `before` would not. `coarse` is the net that `before` would search
  // next, and `fine` the same shape with the knots of this search. Allocates nothing.
  void carry_over(const SelfProximity& before, const ControlNet& coarse, const ControlNet& fine);

  // Removes the points for which `keep` returns false.
  template <class Keep>
  void keep_if(const Keep& keep) {
    near_.keep_if(keep);
  }

  // Returns the points that the last find() found.
  const std::vector<NearPoint>& points() const { return near_.points(); }
  // Returns the number of surface points that the last find() evaluated.
  int evaluations() const { return near_.evaluations(); }
  // Returns true if the last find() found nothing near. The next call then takes almost no time, unless the
  // surface has moved far.
  bool is_clear() const { return clear_; }
  // Returns true if a capacity was exceeded, so that points may be missing. Fewer control points or a smaller
  // margin help.
  bool overflow() const { return missing_elements_ || near_.overflow(); }

 private:
  double moved_since_clear_m(const ControlNet& net) const;
  bool is_still_clear(const ControlNet& net) const;
  std::vector<std::array<int, 2>> find_rings_that_can_meet() const;
  bool can_meet(int ring, int other) const;
  void find_near_elements(double reach);
  // A cell of the finest level and a box around its patch.
  struct NearCell {
    LevelCell cell;
    PatchCorners corners;
    Box box;
  };
  const Box& bounding_box(const LevelCell& element) const;
  void clear_cells();
  std::span<const NearCell> element_cells(const LevelCell& element);
  void offer_elements(const LevelCell& one, const LevelCell& other, double reach);
  void offer_samples(const LevelCell& element, const Box& box, std::span<const NearCell> cells, double reach);
  bool is_contact(const NearPoint& near) const;

  NearPoints near_;
  RestPairs rest_;
  RingSeparation rings_;
  double cell_m_;
  std::vector<Box> boxes_;                        // one for each element, indexed by u and v
  std::vector<double> bulges_;                    // one for each element
  std::vector<std::array<LevelCell, 2>> nearby_;  // pairs of elements that may meet
  struct Slot {
    std::uint32_t generation = 0;  // value of generation_ when the cells were stored
    int first = 0;
  };
  std::vector<Slot> slots_;      // one for each element
  std::vector<NearCell> cells_;  // cells of the stored elements; those of one element begin at Slot::first
  std::uint32_t generation_ = 0;
  int slots_used_ = 0;
  // Control net of the last search in which every two elements were farther apart than the margin plus
  // lead_cells cells, or of a carry_over() after it, until which no point had moved by more than
  // moved_before_m_. Valid while clear_ is true.
  ControlNet clear_net_;
  double moved_before_m_ = 0.0;
  bool clear_ = false;
  bool missing_elements_ = false;
};

}  // namespace spoonbill
