// Fits a cubic B-spline surface to prepared points.
#pragma once

#include <functional>
#include <optional>

#include "engine/base/progress.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/fit_quality.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/scattered_fit.h"

namespace spoonbill {

struct FitSettings {
  int control_u = 24, control_v = 24;  // largest numbers of control points
  // The fit stops adding control points when no point, except outliers, is farther from the surface than
  // this. 0: the fit always uses the full number of control points.
  double tolerance_m = 0.0;
  Progress progress = {};  // a stop request makes the fit fail
};

struct FittedSurface {
  Surface surface;
  std::vector<Vector2> uv;         // parameters of each point
  std::vector<double> distance_m;  // distance of each point from the surface
  // Factor on the weight of each point: 1 for a point near the surface, less for a point far from it, 0 for
  // an outlier.
  std::vector<double> trust;
  FoldCheck folds;
};

// Fits a cubic surface. `start` holds the initial parameters of the nodes. Alternates between least squares
// and closest-point parameters, from few control points to many. Adds knots where errors are large, and gives
// outliers less weight (Huber 1964). The fairness is the largest that cross-validation permits; it is raised
// further where the surface folds.
//
// If the first result folds or has a large error, tries other rules that keep points on their face of a thin
// wall, and returns the best result. The normals of a closed shape point outwards. On an open shape they
// agree with the scan's normals. Without scan normals they point away from a tube's axis, away from a sheet's
// hollow side or, on a flat sheet, to +z.
Result<FittedSurface> fit_surface(const FitPoints& points, const Parameterisation& start,
                                  const FitSettings& settings);

}  // namespace spoonbill
