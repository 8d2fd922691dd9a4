// The box about a surface's control points: never smaller than the surface, and known without evaluating it.
#pragma once

#include "engine/base/box.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

inline Box box_of(const ControlNet& net) {
  Box box{net.point(0, 0), net.point(0, 0)};
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) box = joined(box, Box{net.point(i, j), net.point(i, j)});
  }
  return box;
}

}  // namespace spoonbill
