// What a shell holds between what is kept of its surface and the offset of that by a thickness, against the
// normals. Outside the tick; any thread.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

struct ShellMass {
  double volume_m3 = 0.0;
  Vector3 middle_m = Vector3::Zero();
};

// By the area that a parallel surface has, dA (1 - 2 H s + K s^2) at the depth s (Steiner 1840), with mean
// and Gaussian curvature. True as long as the shell is thinner than the surface's convex radii.
ShellMass shell_mass(const Surface& surface, double thickness_m, const TrimmedArea& area = {});

}  // namespace spoonbill
