// One cell of an implicit block: what it adds to stiffness, masses and report.
#pragma once

#include <array>
#include <vector>

#include "engine/material/cells/hexahedron.h"
#include "engine/material/implicit/block_materials.h"
#include "engine/material/lattice_report.h"

namespace spoonbill {

// Plain data.
struct BlockCell {
  CellCorners corners;
  double share;  // how much of the cell there is
  std::vector<BlockMaterials::Part> parts;
  const std::vector<Material>* materials;

  double volume_m3() const { return share * cell_volume(corners); }
  // Of all of the cell, N/m.
  CellMatrix stiffness() const;
  // By corner, kg: of one material an eighth each.
  std::array<double, 8> masses() const;
  // Adds what cells of this shape achieve of each material in it; `stiffness` is the cell's own.
  void report(const CellMatrix& stiffness, LatticeReport& report) const;
};

// At least one.
std::vector<BlockMaterials::Part> parts_of(const BlockMaterials& materials, std::size_t cell);

}  // namespace spoonbill
