// Merges patches into one surface: finds how they lie beside each other, then joins them along v and along u.
// Pure functions, outside the tick; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/merging/arrangement.h"
#include "engine/merging/join_row.h"

namespace spoonbill {

// Two edges to join, and how they run beside each other where that is not to be found.
struct ChosenEdges {
  PatchEdge a, b;
  std::optional<bool> reversed = {};
};

struct MergeRequest {
  JoinRequest join;
  std::vector<ChosenEdges> chosen;  // in place of those that are found
};

struct MergedJoint {
  PatchEdge a, b;   // of the patches as they were given
  Direction along;  // the direction of the merged surface across the joint
  Joint joint;
  bool closes = false;  // the last edge lies on the first, and the direction is closed around there
};

struct OpenEdges {
  PatchEdge a, b;
  std::string why;
};

struct Merged {
  Surface surface;
  double deviation_m = 0.0;  // the largest distance to the patches, outside blends
  std::vector<MergedJoint> joints;
  std::vector<OpenEdges> left_open = {};  // that touch
};

// A row or a grid whose last edges lie on its first becomes periodic, with the continuity asked at the seam;
// where that fails it stays open. Poles that are chosen, or the nearest of tubes that do not touch, are cut
// off and the tubes bridged; what is cut off belongs to the blend. A bridge may fold over only where the
// direction of an edge is chosen. Refused: no patch or more than 64, two that are one, chosen edges that
// contradict each other or cannot be closed, patches that do not make a row or a grid, what join_row()
// refuses, more of a deviation than the tolerance. Stopped on request. One patch is given back as it is.
Result<Merged> merge(const std::vector<Surface>& patches, const MergeRequest& request);

}  // namespace spoonbill
