// The part of a surface that its trim loops keep: a point's distance from the part, and its area.
#pragma once

#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Computes the distance of a point from the kept part of a surface: the nearest point of a grid, refined by
// Gauss-Newton steps.
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

  // Returns either value for points on a loop.
  bool is_kept(double u, double v) const;

  Surface surface_;
  TrimmedArea area_;
  std::vector<Sample> grid_;
};

// Returns the area by quadrature; for a trimmed surface by the midpoint rule over two hundred lines in each
// direction.
double kept_area_m2(const CadSurface& part);

}  // namespace spoonbill
