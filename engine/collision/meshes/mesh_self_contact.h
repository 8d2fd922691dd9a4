// Where a mesh passes through itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct MeshMeeting {
  std::uint32_t first = 0, second = 0;  // triangles
  // How far each reaches through the other's plane on either side, the least of both: of triangles smaller
  // than that no more than their size tells.
  double depth_m = 0.0;
};

struct MeshMeetings {
  std::vector<MeshMeeting> found;
  bool complete = true;  // false where there are more, too many pairs to be tested, or a stop
};

// Any two triangles that meet count, but for those with a common corner, of which a millionth of their size
// at their rims is left out. `triangles` lie in the order of the tree's leaves. At most so many are found.
// Takes about a microsecond a triangle where they do not; a mesh for which more than 200 pairs a triangle
// must be tested (needles across each other's boxes) is not searched to its end. `progress` only stops it.
MeshMeetings self_meetings(const std::vector<Vector3>& vertices_m,
                           const std::vector<TriangleCorners>& triangles, const BoxTree& tree,
                           std::size_t most, const Progress& progress = {});

// Whether there is any, or may be in a mesh that is not searched to its end.
bool meets_itself(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                  const BoxTree& tree);

}  // namespace spoonbill
