// Checks on solids for reports: self-intersection and thickness of a solid bounded by several surfaces, and
// overlaps between bodies. The checks are deterministic, may run on any thread, and are too slow for a tick.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/inspection/thickness.h"

namespace spoonbill {

struct SolidSelfIntersection {
  Vector3 position_m = Vector3::Zero();
  double depth_m = 0.0;  // lower bound, computed from the two intersecting triangles
};

struct SolidCheck {
  std::vector<SolidSelfIntersection> self_intersections;  // at most 16, the deepest first
  bool self_intersections_complete = true;  // false if the search reached a limit and may have missed some
  // Thinnest wall found along inward lines from the mesh's triangles, measured on the exact surfaces. The
  // true minimum may be smaller by twice the mesh's error, and a wall narrower than 1/200 of the solid's size
  // may be missed. Empty if no line leaves through a wall (exits_through_wall()), as in a tetrahedron.
  std::optional<WallThickness> thinnest;
};

// Checks a solid by its mesh. The mesh must be watertight, have outward normals and deviate from the bounding
// surfaces by at most `error_m`. Intersections no deeper than twice the error are ignored. Thicknesses are
// those of the mesh if `surfaces` is empty or if a surface has inward normals. Returns nothing if `progress`
// stopped the check.
std::optional<SolidCheck> check_solid(const TriangleMesh& mesh, const std::vector<const Surface*>& surfaces,
                                      double error_m, const Progress& progress = {});

// Two bodies that touch or overlap.
struct BodyOverlap {
  std::size_t first = 0, second = 0;  // indices of the two bodies, first < second
  bool contained = false;             // true if one body is inside the other
  double depth_m = 0.0;               // distance by which the first body must move to leave the second
  Vector3 position_m = Vector3::Zero();
};

struct BodyOverlaps {
  // Deepest contact of each touching pair of bodies, in ascending order of the bodies' indices.
  std::vector<BodyOverlap> found;
  bool complete = true;  // false if surfaces are near each other at too many points to search them all
};

// Finds the overlaps of bodies, each bounded by one closed surface with outward normals. FCL's tree selects
// the pairs whose boxes are near each other. Returns nothing if `progress` stopped the search.
std::optional<BodyOverlaps> find_body_overlaps(const std::vector<const Surface*>& bodies,
                                               const Progress& progress = {});

}  // namespace spoonbill
