// Which edges of which patches belong together, found by where they lie. Pure functions, outside the tick;
// any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

// Two edges and how they run beside each other.
struct EdgeMatch {
  PatchEdge a, b;
  bool reversed = false;  // b runs against a
  double seam = 0.0;      // of periodic edges: b's parameter beside a's seam
  // The largest distance between points at equal shares of the way along; of rings, of the period from their
  // seams on.
  double gap_m = 0.0;
  double mean_gap_m = 0.0;
};

// "patch 2's v_start", counted from 1.
std::string text_of(PatchEdge edge);

// How two edges lie beside each other at best, or at best where b runs along or against a as `reversed` says.
// Rings that lie apart are compared as a bend from one to the other would bring them together.
// Refused: a ring beside an open edge.
Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed = std::nullopt);

// The matches that hold the patches together: all pairs of edges that are at most `together_m` apart, then,
// as long as something is loose, the pair of free edges with the smallest mean gap. Refused where the patches
// cannot be held together so; the message names a loose one.
Result<std::vector<EdgeMatch>> matches_of(const std::vector<Surface>& patches, double together_m);

}  // namespace spoonbill
