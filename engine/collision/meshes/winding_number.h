// How often a mesh goes round a point: 1 inside what faces outward, 0 outside, whole numbers for closed ones
// even where they pass through themselves (Jacobson et al. 2013).
#pragma once

#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// What is seen from afar counts as one dipole (Barill et al. 2018). Off by less than 0.1, enough to tell
// whole numbers apart. Never changes once made; at() allocates nothing.
class WindingNumber {
 public:
  // `triangles` lie in the order of the tree's leaves. Mesh and tree must outlive it.
  WindingNumber(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                const BoxTree& tree);

  double at(const Vector3& point_m) const;

 private:
  struct Dipole {
    Vector3 centre_m, area_m2;
    double far_m;  // the distance from which it stands for its triangles
  };
  const std::vector<Vector3>* vertices_m_;
  const std::vector<TriangleCorners>* triangles_;
  const BoxTree* tree_;
  std::vector<Dipole> dipoles_;  // of each node
};

}  // namespace spoonbill
