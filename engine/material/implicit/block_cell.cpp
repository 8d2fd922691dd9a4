#include "engine/material/implicit/block_cell.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {

std::vector<BlockMaterials::Part> parts_of(const BlockMaterials& materials, std::size_t cell) {
  if (materials.of_cell.empty()) return {BlockMaterials::Part{}};
  return materials.of_cell[cell];
}

CellMatrix BlockCell::stiffness() const {
  SPOONBILL_ASSERT(!parts.empty() && materials != nullptr);
  std::vector<HexahedronPart> elastic;
  for (const BlockMaterials::Part& part : parts) {
    const Material& material = (*materials)[part.material];
    elastic.push_back({part.low, part.high, material.youngs_modulus_pa, material.poissons_ratio});
  }
  return hexahedron_stiffness(corners, elastic);
}

std::array<double, 8> BlockCell::masses() const {
  std::array<double, 8> result{};
  if (parts.size() == 1) {
    result.fill((*materials)[parts[0].material].density_kg_per_m3 * share * cell_volume(corners) / 8.0);
    return result;
  }
  for (const BlockMaterials::Part& part : parts) {
    const std::array<double, 8> volumes = part_volumes(corners, part.low, part.high);
    for (std::size_t c = 0; c < 8; ++c) {
      result[c] += (*materials)[part.material].density_kg_per_m3 * share * volumes[c];
    }
  }
  return result;
}

void BlockCell::report(const CellMatrix& stiffness, LatticeReport& report) const {
  report.worst_jacobian = std::min(report.worst_jacobian, smallest_jacobian_ratio(corners));
  std::vector<double> filled(materials->size(), 0.0);
  for (const BlockMaterials::Part& part : parts) {
    filled[part.material] += (part.high - part.low).prod() / 8.0;
  }
  for (std::size_t m = 0; m < filled.size(); ++m) {
    if (filled[m] == 0.0) continue;
    const double youngs = (*materials)[m].youngs_modulus_pa, poisson = (*materials)[m].poissons_ratio;
    const CellMatrix alone = parts.size() == 1 ? stiffness : hexahedron_stiffness(corners, youngs, poisson);
    report.add(filled[m] * volume_m3(), achieved_elasticity(corners, alone), youngs, poisson);
  }
}

}  // namespace spoonbill
