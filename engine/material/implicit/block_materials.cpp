#include "engine/material/implicit/block_materials.h"

#include <algorithm>
#include <utility>

#include "engine/material/implicit/grid_stretches.h"

namespace spoonbill {
namespace {

using Part = BlockMaterials::Part;

// Takes a part that follows the last one along j into it where both are of one material.
void add_part(const Part& part, std::vector<Part>& parts) {
  if (!parts.empty()) {
    Part& last = parts.back();
    const bool follows = last.material == part.material && last.high.y() == part.low.y() &&
                         last.low.x() == part.low.x() && last.low.z() == part.low.z();
    if (follows) {
      last.high.y() = part.high.y();
      return;
    }
  }
  parts.push_back(part);
}

// A cell of one material is one part.
std::vector<Part> merged(std::vector<Part> parts) {
  const bool alike = std::all_of(parts.begin(), parts.end(),
                                 [&](const Part& part) { return part.material == parts[0].material; });
  if (!alike) return parts;
  return {Part{-Vector3::Ones(), Vector3::Ones(), parts[0].material}};
}

}  // namespace

BlockMaterials block_materials(const LatticeMaterials& of, const std::array<int, 3>& lattice_count,
                               const std::array<int, 3>& block_count) {
  BlockMaterials result(of.own());
  if (!of.are_several()) return result;
  result.materials = of.materials;
  LatticeMesh lattice, block;  // for their counting of cells
  lattice.count = lattice_count;
  block.count = block_count;
  result.of_cell.resize(block.cell_count());
  for (int i = 0; i + 1 < block_count[0]; ++i) {
    const std::vector<Stretch> along_i = stretches(i, block_count[0], lattice_count[0]);
    for (int j = 0; j + 1 < block_count[1]; ++j) {
      const std::vector<Stretch> along_j = stretches(j, block_count[1], lattice_count[1]);
      for (int k = 0; k + 1 < block_count[2]; ++k) {
        std::vector<Part> parts;
        for (const Stretch& ck : stretches(k, block_count[2], lattice_count[2])) {
          for (const Stretch& ci : along_i) {
            for (const Stretch& cj : along_j) {
              add_part({{ci.low, cj.low, ck.low},
                        {ci.high, cj.high, ck.high},
                        of.index_of(lattice.cell_index(ci.cell, cj.cell, ck.cell))},
                       parts);
            }
          }
        }
        result.of_cell[block.cell_index(i, j, k)] = merged(std::move(parts));
      }
    }
  }
  return result;
}

}  // namespace spoonbill
