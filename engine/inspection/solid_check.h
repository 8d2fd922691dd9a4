// Whether a solid bounded by several surfaces passes through itself, and how thick it is, by the closed mesh
// that stands for it. For reports. Deterministic; any thread.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/inspection/exact_wall.h"

namespace spoonbill {

struct SolidMeeting {
  Vector3 position_m = Vector3::Zero();
  double depth_m = 0.0;  // at least, by the two triangles that meet
};

struct SolidCheck {
  std::vector<SolidMeeting> self_intersections;  // deepest first
  bool self_meetings_complete = true;       // false where there were too many to be searched
  // From places of its triangles straight inwards to where the line leaves through a wall (line_exit.h), the
  // least found, and that exactly where the surfaces are; another may be less by twice the mesh's error.
  // Walls narrower than a two-hundredth of the solid's size may be missed. Nothing where no line leaves so,
  // as in a tetrahedron.
  std::optional<WallThickness> thinnest;
};

// `mesh` is watertight, with normals out of the material, and nowhere farther than `error_m` from the
// surfaces that bound the solid: parts of it that meet by less than both may be wrong do not count. Where the
// surfaces are unknown, or some face inwards, it tells alone. Nothing where it was stopped.
std::optional<SolidCheck> check_solid(const TriangleMesh& mesh, const std::vector<const Surface*>& surfaces,
                                      double error_m, const Progress& progress = {});

}  // namespace spoonbill
