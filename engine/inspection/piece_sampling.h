// Parameters inside the polynomial pieces of a surface, and the search for extremes among them. Knots are
// left out: derivatives jump there.
#pragma once

#include <functional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// A rectangle of parameters within one polynomial piece.
struct PieceCell {
  double u0, u1, v0, v1;

  double middle_u() const { return 0.5 * (u0 + u1); }
  double middle_v() const { return 0.5 * (v0 + v1); }
};

// Every piece cut into parts x parts cells. The pieces keep a millionth off their ends, so that no derivative
// is taken from the wrong side of a knot, and a hundredth off a collapsed edge, where they drown in rounding.
std::vector<PieceCell> piece_cells(const Surface& surface, int parts);

struct ParameterPlace {
  double u = 0.0, v = 0.0, value = 0.0;
};

// Where `value` is least: over the middles and corners of the cells, then by a search in ever smaller steps
// about the best of them, within their cells. Places where it is not finite do not count; the value is
// infinite where none does.
ParameterPlace least_place(const std::vector<PieceCell>& cells,
                           const std::function<double(double u, double v)>& value,
                           const Progress& progress = {});

}  // namespace spoonbill
