// Two meshes that keep their shape: whether they touch, how far apart they are, and where and how deep they
// are in each other. FCL tells touching and distance; containment, depths and contacts are by our signed
// distances, which FCL lacks or gets wrong (its issues 492, 574 and 106). For reports; never in the tick.
#pragma once

#include <limits>
#include <vector>

#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct MeshPairContact {
  Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();  // the deepest points, one on each mesh
  Vector3 normal = Vector3::UnitY();  // unit, along which the first leaves the second
  double depth_m = 0.0;               // how far; 0 where they only touch
};

struct MeshPairResult {
  bool touching = false;   // decided to touch_tolerance_m
  bool contained = false;  // touching, but the surfaces do not meet: a part of one is inside the other
  bool complete =
      true;  // false where more triangles cross than are searched, so that contacts may be missing
  // Between the nearest points of meshes that do not touch.
  double distance_m = std::numeric_limits<double>::infinity();
  Vector3 nearest_first_m = Vector3::Zero(), nearest_second_m = Vector3::Zero();
  // One for each region in which they meet, the deepest first; empty where they do not touch.
  std::vector<MeshPairContact> contacts;
};

// Closed parts are solid but for their cavities, open ones plates of the thickness, as for MeshDistance; the
// second mesh is where `second_pose` puts it. A contact is the deepest point among the vertices and edges of
// both meshes: along an edge to rounding where the other mesh is convex, else the deepest that steps of a
// thirty-second of its size find. A part that is inside leaves through the nearest wall: its depth is the way
// to the wall and the length of the shorter of both along that way. Deterministic; any thread.
MeshPairResult collide_meshes(const CleanMesh& first, const CleanMesh& second, const Pose& second_pose,
                              double thickness_m = sheet_thickness_m);

}  // namespace spoonbill
