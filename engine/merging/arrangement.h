// Matching of patch edges, and the layout of patches in a grid. The functions have no side effects, may run
// on any thread, and are too slow for a tick.
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
  bool reversed = false;  // b runs in the opposite direction to a
  double seam = 0.0;      // if b is periodic, the parameter on b that corresponds to the seam of a
  // Largest and mean distance between corresponding points. These are points at equal fractions of the arc
  // length or, for rings, at equal fractions of the period from the seams.
  double gap_m = 0.0;
  double mean_gap_m = 0.0;
};

// Returns text such as "patch 2's v_start", with patches counted from 1.
std::string edge_name(PatchEdge edge);

// Returns the best match of two edges. If `reversed` is given, it sets the direction of b relative to a.
// Separate rings are compared after b is rotated to face a. Fails for a ring and an open edge.
Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed = std::nullopt);

// Returns matches that connect all patches. Every pair of edges within `together_m` is matched first. Then
// pairs of free edges are matched, the smallest mean gap first, until all patches are connected. Fails if a
// patch has no suitable edge; the message names it.
Result<std::vector<EdgeMatch>> find_edge_matches(const std::vector<Surface>& patches, double together_m);

// Orientation of a patch in the grid. First u and v may be exchanged, then directions may be reversed.
struct Orientation {
  bool exchanged = false, reversed_u = false, reversed_v = false;

  friend bool operator==(const Orientation&, const Orientation&) = default;
};

Surface orient(const Surface& surface, const Orientation& orientation);

// The side to which an orientation moves a given side, and whether the orientation reverses the direction of
// this side's edge.
struct TurnedSide {
  Side side;
  bool reversed;
};
TurnedSide turn_side(Side side, const Orientation& orientation);

// Grid of rows x columns cells along u and v. Cell (a, b), at index a * columns + b, holds a patch and its
// orientation. The first patch keeps its orientation.
struct Arrangement {
  int rows = 0, columns = 0;
  std::vector<int> patches;
  std::vector<Orientation> orientations;
  // Matches that close the grid. closing_u joins the last row to the first, with one match for each column;
  // closing_v joins the last column to the first, with one match for each row. Empty if the grid is not a
  // ring in that direction.
  std::vector<EdgeMatch> closing_u, closing_v;
  // Matches that neither connect neighbours in the grid nor close it. Their edges are not joined.
  std::vector<EdgeMatch> left_open;

  int cell(int a, int b) const { return a * columns + b; }
};

// Lays out the patches in a grid, from matches that connect them all. A ring of patches starts at the first
// patch. Fails if the patches do not fill a rectangle with one patch in each cell; the message names a patch.
Result<Arrangement> arrange(const std::vector<Surface>& patches, const std::vector<EdgeMatch>& matches);

}  // namespace spoonbill
