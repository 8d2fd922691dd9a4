// Merges patches into one surface: lays them out in a grid, then joins them along v and along u. The
// functions have no side effects, may run on any thread, and are too slow for a tick.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/merging/arrangement.h"
#include "engine/merging/join_row.h"

namespace spoonbill {

// A pair of edges to join. `reversed` is their relative direction; default: the best fit.
struct ChosenEdges {
  PatchEdge a, b;
  std::optional<bool> reversed = {};
};

struct MergeRequest {
  JoinRequest join;
  // Pairs of edges that replace automatic matching; empty for automatic matching.
  std::vector<ChosenEdges> chosen;
};

struct MergedJoint {
  PatchEdge a, b;   // the patches are numbered as they were given
  Direction along;  // direction of the merged surface across the joint
  Joint joint;
  bool closes = false;  // the joint connects the last edge to the first and makes the direction periodic
};

struct OpenEdges {
  PatchEdge a, b;
  std::string reason;
};

struct Merged {
  Surface surface;
  double deviation_m = 0.0;  // largest distance from the patches, outside blends
  std::vector<MergedJoint> joints;
  std::vector<OpenEdges> left_open = {};  // pairs of edges that touch but were not joined
};

// Returns an error for no patches or too many, and for chosen edges that do not exist or contradict each
// other.
Status check_merge(const std::vector<Surface>& patches, const MergeRequest& request);

// Merges patches. A row or grid whose last edges meet its first edges becomes periodic with the requested
// continuity, or stays open if that fails. If a chosen edge, or one of the nearest ends of two tubes, is a
// pole, the pole is cut off and a bridge joins the tubes. Bridges may fold only if some chosen pair has a
// given direction. A single patch is returned unchanged. Fails for no patches, more than 64, or two identical
// ones; for contradicting chosen edges; for patches that do not fill a grid; if join_row() fails; or for a
// deviation above the tolerance. Can be stopped.
Result<Merged> merge(const std::vector<Surface>& patches, const MergeRequest& request);

}  // namespace spoonbill
