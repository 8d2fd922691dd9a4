// Matching of patch edges, and the layout of patches in a grid. Pure functions, outside the tick; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

// Two edges to join and their relative position.
struct EdgeMatch {
  PatchEdge a, b;
  bool reversed = false;  // b runs against a
  double seam = 0.0;      // parameter on b at the seam of a, if b is periodic
  // Largest and mean distance between points at equal fractions of the arc length; for rings, at equal
  // fractions of the period from their seams.
  double gap_m = 0.0;
  double mean_gap_m = 0.0;
};

// Returns text such as "patch 2's v_start", with patches counted from 1.
std::string edge_name(PatchEdge edge);

// Returns the best match of two edges. `reversed`, if given, sets the direction of b relative to a. Separate
// rings are compared after rotating b to face a. Fails for a ring and an open edge.
Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed = std::nullopt);

// Returns matches that connect all patches: first every pair of edges within `together_m`, then pairs of free
// edges, the smallest mean gap first, until no patch is separate. Fails if a patch has no suitable edge; the
// message names it.
Result<std::vector<EdgeMatch>> find_edge_matches(const std::vector<Surface>& patches, double together_m);

// Orientation of a patch in the grid: u and v are exchanged first, then directions reversed.
struct Orientation {
  bool exchanged = false, reversed_u = false, reversed_v = false;

  friend bool operator==(const Orientation&, const Orientation&) = default;
};

Surface orient(const Surface& surface, const Orientation& orientation);

// Side after applying an orientation, and whether the direction of its edge is reversed.
struct TurnedSide {
  Side side;
  bool reversed;
};
TurnedSide turn_side(Side side, const Orientation& orientation);

// Grid of rows x columns cells along u and v. Cell (a, b), at index a * columns + b, holds a patch and its
// orientation. The first patch is not changed.
struct Arrangement {
  int rows = 0, columns = 0;
  std::vector<int> patches;
  std::vector<Orientation> orientations;
  // Matches that close the grid: from the last row to the first, one for each column, and from the last
  // column to the first, one for each row. Empty if the grid is not a ring in that direction.
  std::vector<EdgeMatch> closing_u, closing_v;
  std::vector<EdgeMatch> left_open;  // matches between patches that are not neighbours in the grid

  int cell(int a, int b) const { return a * columns + b; }
};

// Lays out the patches from matches that connect them all. Rings start at the first patch. Fails if the
// patches do not fill a rectangle with one patch in each cell; the message names a patch.
Result<Arrangement> arrange(const std::vector<Surface>& patches, const std::vector<EdgeMatch>& matches);

}  // namespace spoonbill
