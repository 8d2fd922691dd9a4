// The box around a surface's control points: never smaller than the surface, and had without evaluating it.
#pragma once

#include "engine/bspline/surface.h"
#include "render/camera.h"

namespace spoonbill {

inline BoundingBox control_net_box(const Surface& surface) {
  BoundingBox box;
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) box.include(surface.net.point(i, j));
  }
  return box;
}

}  // namespace spoonbill
