// Fits one B-spline surface to a shape given as a function, to a tolerance: the knots of each direction are
// found by themselves, more of them where fitting that direction alone leaves more of an error, then both are
// fitted together (grid_fit.h) and the deviation is measured between the samples. Runs outside the tick; any
// thread.
#pragma once

#include <array>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

struct ShapeFit {
  double tolerance_m = 1e-5;
  int degree = 3;
  // Cells a direction has at least: a lump is to be shaped everywhere.
  int least_spans = 12;
  // Whether sliding along the shape is an error too: where its edges must stay where they are.
  bool keeps_parameters = false;
  // Given, so many control points along u and v, placed where the shape asks for them, and whatever
  // deviation that leaves.
  std::optional<std::array<int, 2>> control_counts = {};
  Progress progress = {};  // stops the fit, which is then an error
};

struct FittedShape {
  Surface surface;
  double deviation_m = 0.0;  // the largest distance found between a point of the surface and the shape
};

// Poles are met exactly, and are smooth where the shape has a tangent plane at them. Refused: a tolerance
// that 200 control points in a direction do not reach, fewer control points than the degree needs, a shape
// that is not finite.
Result<FittedShape> fit_shape(const ExactShape& shape, const ShapeFit& fit = {});

}  // namespace spoonbill
