// What a scanner gives: points, perhaps with normals, perhaps with triangles between them.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct Scan {
  std::vector<Vector3> points_m;
  std::vector<Vector3> normals;  // as many, unit and outwards where they are not zero; or none
  std::vector<TriangleCorners> triangles;

  bool has_normals() const { return !normals.empty(); }
};

// Of all points; zero without any.
double size_of(const std::vector<Vector3>& points_m);

}  // namespace spoonbill
