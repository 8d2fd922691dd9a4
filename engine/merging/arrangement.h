// How patches lie beside each other: their places in a grid and how each is turned into it. Pure functions,
// outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/merging/edge_match.h"

namespace spoonbill {

// First u and v are exchanged, then directions reversed.
struct Orientation {
  bool exchanged = false, reversed_u = false, reversed_v = false;

  friend bool operator==(const Orientation&, const Orientation&) = default;
};

Surface oriented(const Surface& surface, const Orientation& orientation);

// Where a side goes, and whether the edge then runs the other way.
struct TurnedSide {
  Side side;
  bool reversed;
};
TurnedSide turned(Side side, const Orientation& orientation);

// rows x columns cells along u and v; cell (a, b) at index a * columns + b holds the place of a patch and its
// orientation. The first patch lies as it was.
struct Arrangement {
  int rows = 0, columns = 0;
  std::vector<int> patches;
  std::vector<Orientation> orientations;
  // By which every patch of the last row meets that of the first in its column, where the grid is a ring
  // along u; those of its columns where it is one along v.
  std::vector<EdgeMatch> closing_u, closing_v;
  std::vector<EdgeMatch> left_open;  // whose patches lie elsewhere

  int cell(int a, int b) const { return a * columns + b; }
};

// From matches that hold all patches together. Refused where they do not make a full rectangle of cells, each
// with one patch; the message names a patch. A ring starts at the first patch.
Result<Arrangement> arrange(const std::vector<Surface>& patches, const std::vector<EdgeMatch>& matches);

}  // namespace spoonbill
