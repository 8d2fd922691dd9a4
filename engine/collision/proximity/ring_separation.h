// Which rings of a surface, its elements between two knots of v, can be near each other now: by boxes, then
// across each ring's own axis. All of a long body that is not folded is told apart in a few microseconds.
#pragma once

#include <array>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_bounds.h"

namespace spoonbill {

// One owner, one thread; allocates only when made.
class RingSeparation {
 public:
  // `pairs`: the elements of v to look at.
  RingSeparation(const KnotVector& v, std::vector<std::array<int, 2>> pairs);

  // Those that no plane found keeps farther apart than `reach_m`. Takes the boxes of `bounds`, which must be
  // of the net's knots.
  const std::vector<std::array<int, 2>>& near(const ControlNet& net, SurfaceBounds& bounds, double reach_m);

 private:
  struct Interval {
    double low, high;
  };
  void take_centres(const ControlNet& net);
  void take_intervals(const ControlNet& net, int ring);
  Interval interval(int ring, int along) const;
  bool are_apart_along(const ControlNet& net, int axis_ring, int other, double reach_m);

  int columns_, width_;      // control columns: of the net, of a ring
  std::vector<int> column_;  // of each ring, `width_` of them
  std::vector<std::array<int, 2>> pairs_, near_;
  std::vector<Vector3> centres_;    // of each control column
  std::vector<double> low_, high_;  // of each ring's axis, of each control column along it
  std::vector<Box> boxes_;          // of each ring
  std::vector<char> taken_;         // whether a ring's are those of now
};

}  // namespace spoonbill
