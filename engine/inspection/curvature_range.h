// Principal curvatures of what is kept of a surface, and where they are smallest and largest. Pure functions,
// outside the tick; any thread.
#pragma once

#include <optional>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// By metre; above zero where the surface is convex, seen from the side that its normals (du x dv) point to:
// a ball of radius r with its normals outwards has 1 / r twice.
struct PrincipalCurvatures {
  double smallest = 0.0, largest = 0.0;
};

// None where du x dv vanishes.
std::optional<PrincipalCurvatures> principal_curvatures(const SurfacePoint& point);

struct CurvaturePlace {
  double curvature_per_m = 0.0;
  double u = 0.0, v = 0.0;
  Vector3 position_m = Vector3::Zero();
};

struct CurvatureRange {
  CurvaturePlace smallest, largest;
};

// Over all pieces of the surface, on both sides of each knot, from samples refined where the extremes are, up
// to a hundredth of a piece from a pole. A smooth extreme comes out to a millionth.
CurvatureRange curvature_range(const Surface& surface, const TrimmedArea& area = {},
                               const Progress& progress = {});

// The integral of the squares of both principal curvatures over the area, 8 pi of a ball of any size: small
// where a surface is fair.
double bending_measure(const Surface& surface, const TrimmedArea& area = {});

}  // namespace spoonbill
