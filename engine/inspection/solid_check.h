// Checks on solids for reports: self-intersection and thickness of a solid bounded by several surfaces, and
// overlaps between bodies. Outside the tick; deterministic; any thread.
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
  double depth_m = 0.0;  // lower bound, from the two intersecting triangles
};

struct SolidCheck {
  std::vector<SolidSelfIntersection> self_intersections;  // deepest first
  bool self_intersections_complete = true;                // false: there are too many to search them all
  // Thinnest wall found along inward lines from the mesh's triangles, measured on the exact surfaces.
  // Another wall may be thinner by twice the mesh's error, and a wall narrower than 1/200 of the solid's
  // size may be missed. Empty if no line leaves through a wall (exits_through_wall()), as in a
  // tetrahedron.
  std::optional<WallThickness> thinnest;
};

// Checks a solid by its mesh, which must be watertight, have outward normals and be nowhere farther than
// `error_m` from the bounding surfaces. Ignores intersections no deeper than twice the error. Without
// usable surfaces (none, or some facing inwards), thicknesses are those of the mesh. Returns nothing if
// `progress` stopped it.
std::optional<SolidCheck> check_solid(const TriangleMesh& mesh, const std::vector<const Surface*>& surfaces,
                                      double error_m, const Progress& progress = {});

// Two bodies that touch or overlap.
struct BodyOverlap {
  std::size_t first = 0, second = 0;  // indices of the bodies, first < second
  bool contained = false;             // one body is inside the other
  double depth_m = 0.0;               // distance by which the first must move to leave the second
  Vector3 position_m = Vector3::Zero();
};

struct BodyOverlaps {
  std::vector<BodyOverlap> found;  // deepest contact of each touching pair, in the order of the pairs
  bool complete = true;  // false: surfaces are near each other in too many points to search them all
};

// Finds the overlaps of bodies, each bounded by one closed surface with outward normals. FCL's tree selects
// the pairs whose boxes are near each other. Returns nothing if `progress` stopped it.
std::optional<BodyOverlaps> find_body_overlaps(const std::vector<const Surface*>& bodies,
                                               const Progress& progress = {});

}  // namespace spoonbill
