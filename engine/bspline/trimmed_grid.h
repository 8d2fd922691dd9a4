// The triangles of a grid on a trimmed surface: whole cells where all is kept, and of the cells that loops
// cross what is on their kept side, cut along the loops. Pure, outside the tick; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// A vertex between the grid's samples. Interpolated bilinearly among the corners of its cell it lies on the
// chords of that cell, so that neighbours meet without a gap.
struct CutVertex {
  double u = 0.0, v = 0.0;
  std::array<std::uint32_t, 4> corners{};  // samples of the grid, counter-clockwise from the lowest u and v
  std::array<double, 4> weights{};         // sum to 1
};

struct TrimmedGrid {
  std::vector<CutVertex> vertices;  // numbered on from the grid's samples
  // Counter-clockwise with u to the right and v up. No vertex lies within another triangle's side.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Sample (i, j) of the grid has the number i * columns + j. A periodic direction may leave the seam's second
// line out; its last cells then end at the first line. The parameters must include both ends of an open
// direction.
TrimmedGrid trim_grid(const GridDirection& u, const GridDirection& v, const TrimmedArea& area);

// The share of a surface's area that is kept, to about the square of a chord: by triangles of eight cells for
// each polynomial piece.
double kept_area_share(const Surface& surface, const TrimmedArea& area);

}  // namespace spoonbill
