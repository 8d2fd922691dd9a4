#include "tests/engine/material/composite.h"

namespace spoonbill {

LatticeMaterials composite(const LatticeMesh& mesh, const Material& first, const Material& second,
                           const std::function<bool(const Vector3&)>& is_second) {
  LatticeMaterials materials(first);
  materials.materials.push_back(second);
  materials.material_index.assign(mesh.cell_count(), 0);
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        Vector3 middle = Vector3::Zero();
        for (const Vector3& corner : mesh.cell(i, j, k)) middle += corner / 8.0;
        if (is_second(middle)) materials.material_index[mesh.cell_index(i, j, k)] = 1;
      }
    }
  }
  return materials;
}

}  // namespace spoonbill
