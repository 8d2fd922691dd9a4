// The nearest point of a cell of samples, taken as two triangles.
#pragma once

#include "engine/collision/levels/surface_levels.h"

namespace spoonbill {

// Shares along u and v of the cell.
struct OnCell {
  double u, v, distance;
};
OnCell nearest_on_cell(const Vector3& point, const PatchCorners& at);

}  // namespace spoonbill
