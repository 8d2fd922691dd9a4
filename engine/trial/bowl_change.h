// Variations of the bowl of a body, to see what its sizes do.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/trial/bowl.h"

namespace spoonbill {

// Factors on the sizes of a bowl.
struct BowlChange {
  double depth = 1.0, width = 1.0;
  // Factor on the curvature at the lowest point, with the same depth and width: a smaller factor makes a
  // flatter bottom and steeper sides.
  double curvature = 1.0;
  friend bool operator==(const BowlChange&, const BowlChange&) = default;
};
inline constexpr Range<double> bowl_factor_range{0.25, 4.0};

// Changes a bowl by moving the control points below its rim and beside it. A point at height -z below the
// plane of the rim, in a bowl of the depth D, goes to -z' with z' / (D depth) = (z / D)^curvature; for a
// paraboloid, 1 - z / D = r^2, so that the curvature at r = 0 grows by that factor. Behind the rim the change
// fades to nothing over a fifth of the bowl's length, so that a handle keeps its shape.
void change_bowl(const Bowl& bowl, const BowlChange& change, Surface& surface);

}  // namespace spoonbill
