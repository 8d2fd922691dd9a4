// The convex hull of points as triangles and edges, to be looked at. Contact itself asks convex_hull.h, which
// builds none.
#pragma once

#include <array>
#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Indices into the points.
struct HullFacets {
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise from outside
  std::vector<std::array<int, 2>> edges;      // between triangles that bend by half a degree or more
};

// For points rounded to 2^20 steps of their box's longest side, on which the sign of a volume is exact: the
// points themselves are outside by less than one step. Empty where they lie in one plane or are not finite.
// Takes time with points times triangles, half a second at the most that a control net has. Any thread.
HullFacets hull_facets(const std::vector<Vector3>& points_m);

}  // namespace spoonbill
