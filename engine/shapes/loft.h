// A surface through sections: a starting shape.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/pose.h"
#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// The points of each section in their order, without repeating the first. A first or last section of a single
// point is a pole.
struct LoftSections {
  std::vector<std::vector<Vector3>> sections_m;
  bool closed = true;  // all of them, around
  // How far caps bulge over the first and the last of closed sections; half their mean radius unless told.
  // Flat ones would meet the sides at an edge: a bulge goes on from the sides' tangents.
  std::optional<double> cap_m = {};
  bool caps = true;  // otherwise the ends stay open
};

// A curve through each section and smooth curves across them; closed sections are turned about and started so
// that they lie to each other as well as may be. A shape with both ends closed has its outside outside.
// Refused: fewer than two sections, sections of too few points or beyond the range of sizes.
Result<ExactShape> loft_shape(LoftSections sections);

}  // namespace spoonbill
