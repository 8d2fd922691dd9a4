// The bowl of a spoon, made from its sizes.
#pragma once

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// A bowl that opens upwards, with its front at +x. Its edge, the line along the crest of the round rim, is an
// ellipse around the origin. The wall is equally thick everywhere but at the rim, which is rounded. Halfway
// between the inside and the outside is an elliptic paraboloid.
struct BowlSize {
  double length_m = 0.06, width_m = 0.042;  // outer sizes along x and z, without the pitch
  double depth_m = 0.01;   // of the inside, from its lowest point up to the highest point of the rim
  double rim_m = 0.001;    // thickness of the wall, and twice the radius of the rim's edge
  double pitch_deg = 0.0;  // of the rim; a positive angle lifts the front
};

inline constexpr Range<double> bowl_pitch_range_deg{-60.0, 60.0};
// Range of the thickness of the rim, as a fraction of the shorter side of the bowl.
inline constexpr Range<double> bowl_rim_fraction_range{0.01, 0.1};
// Range of the depth, as a fraction of the shorter side of the bowl.
inline constexpr Range<double> bowl_depth_fraction_range{0.02, 0.5};
inline constexpr double max_bowl_slenderness = 4.0;  // largest ratio of its sides

// Makes a bowl, which is a closed tube with poles at the two ends of its rim. v runs from the back to the
// front. The lines u = 0 and u = 1/2 are the edge; u from 0 to 1/2 is the outside.
Result<ExactShape> bowl_shape(const BowlSize& size);

// Returns the reach of a bowl (see reach_m() in stock_shapes.h).
double bowl_reach_m(const BowlSize& size);

}  // namespace spoonbill
