// Area of what is kept of a surface, and volume and middle of what a closed one encloses, by quadrature
// (area_quadrature.h) and, for the inside, the divergence theorem. Pure functions, outside the tick; any
// thread.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

struct EnclosedMass {
  double area_m2 = 0.0;
  Vector3 area_middle_m = Vector3::Zero();
  // Of a closed surface without trims; above zero where its normals point outwards. Exact but for rounding:
  // the integrand is a polynomial.
  double volume_m3 = 0.0;
  Vector3 middle_m = Vector3::Zero();
};

EnclosedMass enclosed_mass(const Surface& surface, const TrimmedArea& area = {});

}  // namespace spoonbill
