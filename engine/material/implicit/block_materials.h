// What the cells of an implicit block are made of.
#pragma once

#include <array>
#include <vector>

#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice_materials.h"

namespace spoonbill {

// Plain data; a value.
struct BlockMaterials {
  // A box in a cell's natural coordinates, as HexahedronPart has it, and which of the materials fills it.
  struct Part {
    Vector3 low = -Vector3::Ones(), high = Vector3::Ones();
    std::size_t material = 0;
  };

  // Of one: not explicit, since that is what most blocks are.
  BlockMaterials(const Material& material) : materials{material} {}

  std::vector<Material> materials;
  std::vector<std::vector<Part>> of_cell;  // by LatticeMesh::cell_index(), each filled; empty: the first
};

// Of a coarser grid over the same block: each of its cells is filled by the lattice's cells that lie in it,
// in the grid's coordinates.
BlockMaterials block_materials(const LatticeMaterials& of, const std::array<int, 3>& lattice_count,
                               const std::array<int, 3>& block_count);

}  // namespace spoonbill
