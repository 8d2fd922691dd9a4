// The part of a surface that its trim loops keep: how far a point is from it, and how large it is.
#pragma once

#include <vector>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// The distance of a point from the kept part of a surface: the nearest of a grid, followed by Gauss-Newton
// steps.
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

  // On a loop either answer is right.
  bool is_kept(double u, double v) const;

  Surface surface_;
  TrimmedArea area_;
  std::vector<Sample> grid_;
};

// By quadrature; of a trimmed one by the midpoint rule over two hundred lines each way.
double kept_area_m2(const CadSurface& part);

}  // namespace spoonbill
