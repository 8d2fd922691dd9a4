// How high the skin of a body is above a plane.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// The height is itself a spline, with the heights of the control points for its coefficients: sampled four
// times an element in each direction, and between samples as low as the parabolas through them and their
// neighbours. One owner, one thread; allocates only when made.
class SkinHeights {
 public:
  // Of all surfaces with these knots.
  static Result<SkinHeights> make(const KnotVector& u, const KnotVector& v);

  int rows() const { return nested_.grid.rows(); }
  int columns() const { return nested_.grid.columns(); }
  double u(int row) const { return nested_.grid.u.parameters[static_cast<std::size_t>(row)]; }
  double v(int column) const { return nested_.grid.v.parameters[static_cast<std::size_t>(column)]; }

  // False where all of the skin is higher than `reach_m`; what parts of it are, may be left out.
  bool take(const Surface& surface, const Vector3& point_m, const Vector3& normal, double reach_m);
  // About a sample, up to the next ones, as far as it was taken: infinite where it was not.
  double lowest_m(int row, int column) const;

 private:
  explicit SkinHeights(NestedGrid nested);
  bool take_row(int row, double reach_m);
  double height(int row, int column) const {
    return height_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns()) +
                   static_cast<std::size_t>(column)];
  }
  double dip_along_u(int row, int column) const;
  double dip_along_v(int row, int column) const;

  NestedGrid nested_;
  std::vector<double> control_;  // of the control points
  std::vector<double> blended_;  // of one row of samples, by column of control points
  std::vector<double> height_;   // of the samples
};

}  // namespace spoonbill
