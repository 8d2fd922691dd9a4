// Whether a surface closes, and how far apart its edges are where it does not. Pure functions, outside the
// tick; any thread.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Edges nearer than this are one.
inline constexpr double closing_tolerance_m = 1e-6;

enum class Closedness {
  solid,  // bounds a body: closed around one direction and by poles or itself along the other
  tube,   // closed around one direction, open along the other
  sheet,  // open both ways
};

// Along one direction: how far apart its two ends are. 0 where it is periodic.
struct EdgeGap {
  double apart_m = 0.0;                            // between the points of both ends that belong together
  double first_width_m = 0.0, last_width_m = 0.0;  // how far from a single point each end is
};

struct Closing {
  Closedness closedness = Closedness::sheet;
  EdgeGap u, v;
  // What is missing to a closed surface: 0 for a solid, the width of the widest open end otherwise.
  double gap_m = 0.0;
};

// By samples along the edges.
Closing closing_of(const Surface& surface);

}  // namespace spoonbill
