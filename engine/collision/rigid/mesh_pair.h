// Contact of two rigid meshes: whether they touch, their distance, and the position and depth of each
// contact. FCL decides whether they touch, and computes the distance. Containment, positions and depths come
// from signed distances, because FCL tests surfaces only, reports no depth between meshes and can misplace
// contacts at corners of triangles. For reports; too slow for a tick.
#pragma once

#include <limits>
#include <vector>

#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// One region in which two meshes overlap or touch.
struct MeshPairContact {
  // Points between which the depth is measured: the deepest point of one mesh, and the point of the other
  // mesh's surface nearest to it. If a connected part of a mesh is entirely inside the other mesh, they are
  // the nearest points of the two surfaces instead.
  Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();
  // Unit vector in the direction in which the first mesh leaves the second.
  Vector3 normal = Vector3::UnitY();
  double depth_m = 0.0;  // depth along the normal; 0 if the meshes only touch
};

// Result of collide_meshes().
struct MeshPairResult {
  bool touching = false;   // true if the meshes touch, to within touch_tolerance_m
  bool contained = false;  // true if the surfaces do not cross, but a connected part is inside the other mesh
  bool complete = true;    // false if more triangles cross than the limit, so that contacts may be missing
  // Nearest points of meshes that do not touch, and their distance.
  double distance_m = std::numeric_limits<double>::infinity();
  Vector3 nearest_first_m = Vector3::Zero(), nearest_second_m = Vector3::Zero();
  // Contacts, one per region, the deepest first; empty if the meshes do not touch.
  std::vector<MeshPairContact> contacts;
};

// Finds the contacts or the distance of two meshes. `second_pose` is the pose of the second mesh in the frame
// of the first. Closed parts are solid except for their cavities; open parts are plates of the given
// thickness, as in MeshDistance.
//
// The position of a contact is the deepest of the vertices and edge points of both meshes in a region. On
// edges it is exact up to rounding if the other mesh is convex; otherwise edges are searched in steps of 1/32
// of that mesh's size. If a part is entirely inside another, its depth is measured in the direction of the
// nearest wall: the distance to the wall plus the length of the shorter part along this direction.
// Deterministic. May be called from any thread.
MeshPairResult collide_meshes(const CleanMesh& first, const CleanMesh& second, const Pose& second_pose,
                              double thickness_m = sheet_thickness_m);

}  // namespace spoonbill
