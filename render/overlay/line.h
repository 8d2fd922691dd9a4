// A straight line on the screen between two points of the world, as wide in pixels wherever it is.
#pragma once

#include <Eigen/Core>

#include "render/overlay/palette.h"

namespace spoonbill {

struct OverlayLine {
  Eigen::Vector3f start_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f end_m = Eigen::Vector3f::Zero();
  Colour start_colour;
  Colour end_colour;
  float width_px = 1.0f;  // before the interface scale
};

}  // namespace spoonbill
