// Motion of a surface since an earlier time, from its control points.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Remembers the control points of a surface. Has one owner, on one thread. Allocates only on construction.
class NetMotion {
 public:
  explicit NetMotion(int control_points);

  // Remembers the control points relative to `frame`. There must be as many as on construction.
  void remember(const ControlNet& net, const Pose& frame);
  void forget() { is_known_ = false; }
  // Returns an upper bound of how far a point of the surface has moved relative to the frame since
  // remember(), m; infinite before. Not a number if a control point is not finite. A point of a B-spline
  // surface is a weighted mean of control points, so it moves no farther than one of them.
  double since_m(const ControlNet& net, const Pose& frame) const;

 private:
  std::vector<Vector3> points_m_;  // relative to the frame
  bool is_known_ = false;
};

}  // namespace spoonbill
