// A small flat sign at a point of the world, facing the eye.
#pragma once

#include <Eigen/Core>

#include "render/overlay/palette.h"

namespace spoonbill {

enum class MarkShape { square, disc, diamond };

struct OverlayMark {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Colour colour;
  float radius_m = 0.0f;  // half its width in the world
  float least_px = 2.0f;  // and at least so much on the screen, before the interface scale
  float shape = 0.0f;     // a MarkShape
};

}  // namespace spoonbill
