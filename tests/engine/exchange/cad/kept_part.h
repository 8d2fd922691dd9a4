// Measures the part of a surface that its trim loops keep: the distance of a point from that part, and its
// area.
#pragma once

#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Computes the distance of a point from the kept part of a surface. The search starts from the nearest points
// of a grid and refines them by Gauss-Newton steps.
class NearestKeptPoint {
 public:
  explicit NearestKeptPoint(const CadSurface& part);

  double distance_m(const Vector3& from) const;

 private:
  struct Sample {
    double u, v;
    Vector3 at;
  };

  double polished(const Sample& start, const Vector3& from) const;

  // Returns true if the point is inside the kept part, or outside by at most a hundred-thousandth of the
  // domain, so that points on a loop count as kept.
  bool is_kept(double u, double v) const;

  Surface surface_;
  TrimmedArea area_;
  std::vector<Sample> grid_;
};

// Returns the area of the kept part. An untrimmed surface is integrated by Gauss quadrature, a trimmed one by
// the midpoint rule with 200 lines in each direction.
double kept_area_m2(const CadSurface& part);

}  // namespace spoonbill
