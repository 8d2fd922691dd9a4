// A surface fitted to points, from first parameters to the last control point.
#pragma once

#include <functional>
#include <optional>

#include "engine/base/progress.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/folds.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/scattered_fit.h"

namespace spoonbill {

struct FitSettings {
  int control_u = 24, control_v = 24;  // as many control points at most
  double tolerance_m = 0.0;            // no more of them once all but outliers lie within; 0: all of them
  Progress progress = {};              // stops the fit, which is then an error
};

struct FittedSurface {
  Surface surface;
  std::vector<Vector2> uv;         // of each point
  std::vector<double> distance_m;  // of each point
  std::vector<double> trust;       // of each point, 1 to 0: what is far off weighs less, a stray nothing
  FoldCheck folds;
};

// Cubic. `start` gives the nodes their first parameters. Alternates least squares with new parameters by the
// closest points, from few control points to many, knots where errors are; outliers weigh less (Huber 1964).
// The fairness is the most that points left out of a fit bear; where the surface folds it is raised until it
// does not, or no further. Of several ways to hold points to their face of a thin wall the best is taken.
// Closed shapes get outward normals, open ones those of the scan; of a scan without them they face away from
// a tube's axis and a sheet's hollow side, or towards +z.
Result<FittedSurface> fit_surface(const FitPoints& points, const Parameterisation& start,
                                  const FitSettings& settings);

}  // namespace spoonbill
