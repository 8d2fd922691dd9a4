// A part of a body in the body's own coordinates, so that it stays where it is however the body is bent: what
// has a material or a friction of its own, is loaded, or is fixed.
#pragma once

#include <limits>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Where a point of a body is, in the body's own coordinates; not a number of a node beside the body.
struct BodyPlace {
  double along = 0.0;   // of the body's length, 0 to 1; of a ring, of its turn
  double around = 0.0;  // of a turn, 0 to 1; 0 on the axis, which has none
  double depth_m = 0.0;
};

// Plain data. All of the body as it is made.
struct BodyRegion {
  Range<double> along{0.0, 1.0};   // of the body's length in the sense of v; of a ring, of its turn
  Range<double> around{0.0, 1.0};  // of a turn in the sense of u; low above high: across the seam
  Range<double> depth_m{0.0, std::numeric_limits<double>::infinity()};  // below the surface, at rest
};

bool contains(const BodyRegion& region, const BodyPlace& place);

// The shares within 0 to 1 and in order, the depths at least 0 and in order; the message names the field.
Status check_region(const BodyRegion& region);

}  // namespace spoonbill
