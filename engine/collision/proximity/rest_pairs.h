// Which points of one body's surface can ever come together from outside, by where they lie at rest. The rest
// are neighbours, or look at each other through the body.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Nearer than this along the surface at rest, in lattice cells and in thicknesses of the body (twice its
// volume over its area), whichever is more, points are neighbours. A bar whose inner side meets itself, bent
// to a loop that leaves its ends crossing, is longer than 4.4 times the radius that it is bent to: three
// thicknesses leave it a radius of two thirds of one.
inline constexpr double neighbour_cells = 4.0;
inline constexpr double neighbour_thicknesses = 3.0;

// Up to so many times that, two points that look into the body towards each other are its two sides. What is
// between them never gives way so far that they meet; farther apart, as the ends of a bar, they may come
// round and meet.
inline constexpr double through_body = 2.0;

// Immutable once made.
class RestPairs {
 public:
  // The surface at rest, with the knots of the grid; du x dv points outwards. `cell_m` is the lattice's.
  RestPairs(const Grid& grid, Surface rest, double cell_m);

  // Two samples of the grid, or two places between.
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
  void reach_from(int block, std::vector<double>& distances) const;
  double step_between(int block, int other) const;

  Surface rest_;
  std::vector<double> u_, v_;  // where the blocks of parameters begin, and where the last ends
  double cell_m_, neighbour_m_ = 0.0;
  std::vector<RestPoint> points_;  // of each sample
  std::vector<Vector3> middles_;   // of each block
  std::vector<bool> neighbours_;   // by block and block: whether they are near along the surface
};

}  // namespace spoonbill
