// Materials of a lattice: one for the whole body, or several by region, each with its own friction.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/result.h"
#include "engine/material/lattice/body_coordinates.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Material of each cell and friction of each node. They stay with the cells and nodes while the body's shape
// changes. A plain value type.
struct LatticeMaterials {
  // Creates the materials of a uniform body. An implicit conversion, because most bodies are uniform.
  LatticeMaterials(const Material& own) : materials{own}, frictions{own.friction} {}

  std::vector<Material> materials;  // the body's own material, then those of its regions
  // Index into `materials` for each cell, by LatticeMesh::cell_index(); empty if every cell has the first
  // material.
  std::vector<std::uint8_t> material_index;
  std::vector<double> frictions;  // friction coefficient of the body, then those of its regions
  // Index into `frictions` for each node; empty if every node has the first friction.
  std::vector<std::uint8_t> friction_index;

  const Material& own() const {
    SPOONBILL_ASSERT(!materials.empty());
    return materials.front();
  }
  std::size_t index_of(std::size_t cell) const { return material_index.empty() ? 0 : material_index[cell]; }
  const Material& of(std::size_t cell) const { return materials[index_of(cell)]; }
  double friction(int node) const {
    return frictions[friction_index.empty() ? 0 : friction_index[static_cast<std::size_t>(node)]];
  }
  bool has_several_materials() const { return !material_index.empty(); }
  // Replaces the material of the body outside its regions.
  void set_own(const Material& material) {
    SPOONBILL_ASSERT(!materials.empty() && !frictions.empty());
    materials.front() = material;
    frictions.front() = material.friction;
  }
};

// Returns the materials and frictions of a body with regions. A cell gets the material of the last region
// that has a material and contains the cell's centre (see find_cell_coordinates()). A node gets the friction
// of the last region that contains the node; a region without a friction has the friction of its material.
// Fails if a region does not pass check_material_region(). Also fails if a region with a material contains no
// centre of a filled cell, or if a region with a friction of its own contains no surface node.
Result<LatticeMaterials> lattice_materials(const LatticeMesh& mesh, const Material& own,
                                           std::span<const MaterialRegion> regions);

// Checks that each material is within its ranges. If any material is not linear elastic, the body needs
// springs, so every material must have a Poisson's ratio that springs can represent.
Status check_materials(const LatticeMaterials& materials);

// Returns whether is_linear_elastic() is true for every material.
bool are_linear_elastic(const LatticeMaterials& materials);
double max_youngs_modulus_pa(const LatticeMaterials& materials);
double min_poissons_ratio(const LatticeMaterials& materials);

}  // namespace spoonbill
