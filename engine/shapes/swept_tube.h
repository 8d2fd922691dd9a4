// A tube along a line, closed by round ends: a starting shape.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

// An elliptic section, carried along the curve without turning about it (double reflection, Wang et al.
// 2008). At the curve's start its width lies level, or along x where the curve goes straight up. The ends are
// halves of ellipsoids, as long as the smaller half axis.
struct TubeSize {
  SmoothCurve middle;
  double half_width_m = 0.005, half_height_m = 0.005;
};

// Refused: sizes out of range, a curve that bends more sharply than the tube is wide, saying where.
Result<ExactShape> tube_shape(const TubeSize& size);

}  // namespace spoonbill
