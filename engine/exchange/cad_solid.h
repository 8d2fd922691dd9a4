// Solids that are joined of several faces, as meshes and in numbers. Plain data.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct CadSolid {
  std::string name;
  std::vector<std::size_t> places;  // among the model's surfaces, of its faces, its cavities' too; ascending
  TriangleMesh mesh;                // watertight; normals out of the material
  // No sample of its faces and edges is farther from the triangle that stands for it.
  double chord_error_m = 0.0;
  double gap_m = 0.0;  // the widest between two faces that one edge joins
  double volume_m3 = 0.0, area_m2 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // of its material, were that of one density
};

struct CadSolids {
  std::vector<CadSolid> solids;
  std::vector<std::size_t> loose;  // places among the model's surfaces of those that are no faces of them
  std::vector<std::string> notes;  // a line each
};

struct SolidMeshing {
  double chord_m = 5e-5;
  std::size_t triangle_limit = 10'000'000;  // of all solids together
};

}  // namespace spoonbill
