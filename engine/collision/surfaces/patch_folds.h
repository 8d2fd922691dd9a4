// Which patches of a surface provably do not meet themselves: where both tangents stay within cones that have
// no line in common.
//
// Over a rectangle of parameters S(p) - S(q) = (u_p - u_q) a + (v_p - v_q) b, where a is the mean of S_u and
// b that of S_v over the way from q to p. Each mean lies in the convex cone of its tangents. Where the cones
// about the axes A and B have the half angles alpha and beta, and the lines of A and B are more than
// alpha + beta apart, a and b are never parallel, and the difference never vanishes. Stronger than a cone of
// normals (Volino and Magnenat-Thalmann 1994), which must look at the rim of the patch as well: a flat spiral
// has one normal and still overlaps itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// One owner, one thread; allocates only when made. The levels must outlive it.
class PatchFolds {
 public:
  explicit PatchFolds(SurfaceLevels& levels);

  // After SurfaceLevels::begin().
  void begin();

  // Cells of one level that make up a rectangle, across a seam too. False where it is not proven.
  bool never_meets_itself(std::span<const LevelCell> cells);

 private:
  struct Cone {
    Vector3 axis = Vector3::Zero();  // unit
    double angle = 0.0;              // up to a right angle, or more than that: all directions
  };
  struct Cones {
    Cone along_u, along_v;
  };
  const Cones& cones_of(const LevelCell& cell);
  Cones take_cones(const LevelCell& cell);
  void take_mixed();

  SurfaceLevels* levels_;
  // Of S_uv over each element, by u and v: the largest length, as SurfaceBounds has those of S_uu and S_vv.
  std::vector<double> mixed_;
  struct Direction {
    std::vector<int> span, control;  // of each element; unrolled index to control index
    std::vector<double> scale;       // degree / (u_{i+p+1} - u_{i+1}) of the unrolled index i
    int degree = 0;
  };
  static Direction unroll(const KnotVector& knots);
  Direction u_, v_;
  std::vector<double> steps_;  // working memory: |difference of differences|, by unrolled control point
  std::vector<Cones> cones_;   // by SurfaceLevels::cell_index()
  std::vector<std::uint32_t> taken_at_;
  std::uint32_t begun_ = 0;
};

}  // namespace spoonbill
