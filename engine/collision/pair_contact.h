// Where two surfaces, or two parts of one, cross or touch.
#pragma once

#include "engine/collision/pair_polish.h"
#include "engine/collision/parameter_range.h"

namespace spoonbill {

// One region in which the surfaces cross or touch.
struct PairContact {
  SurfacePair pair;              // the deepest points, one on each surface
  Vector3 normal;                // unit, along which the first surface leaves the second
  double depth_m = 0.0;          // how far; 0 where they only touch
  ParameterRange first, second;  // all of the region is within
};

}  // namespace spoonbill
