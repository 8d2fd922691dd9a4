// What a lattice is made of: one material, or several by region, with a friction of their own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/result.h"
#include "engine/material/lattice/body_place.h"
#include "engine/scene/material.h"

namespace spoonbill {

// By cell and by node, so that a body keeps it while its shape changes. Plain data; a value.
struct LatticeMaterials {
  // Of one material: not explicit, since that is what most bodies are.
  LatticeMaterials(const Material& own) : materials{own}, frictions{own.friction} {}

  std::vector<Material> materials;    // the body's own, then those of its regions
  std::vector<std::uint8_t> of_cell;  // which of them, by LatticeMesh::cell_index(); empty: all the first
  std::vector<double> frictions;      // the body's own, then those of its regions
  std::vector<std::uint8_t> friction_of_node;  // which of them; empty: all the first

  const Material& own() const {
    SPOONBILL_ASSERT(!materials.empty());
    return materials.front();
  }
  std::size_t index_of(std::size_t cell) const { return of_cell.empty() ? 0 : of_cell[cell]; }
  const Material& of(std::size_t cell) const { return materials[index_of(cell)]; }
  double friction(int node) const {
    return frictions[friction_of_node.empty() ? 0 : friction_of_node[static_cast<std::size_t>(node)]];
  }
  bool are_several() const { return !of_cell.empty(); }
  // Makes the rest of the body, beside its regions, of another material.
  void set_own(const Material& material) {
    SPOONBILL_ASSERT(!materials.empty() && !frictions.empty());
    materials.front() = material;
    frictions.front() = material.friction;
  }
};

// A cell is made of what the last region with a material that holds its middle says (see cell_places()), a
// node of the surface is as rough as the last region that holds it says. Refused: what
// check_material_region() refuses, and a region that holds no cell, or whose friction no node of the surface
// has.
Result<LatticeMaterials> lattice_materials(const LatticeMesh& mesh, const Material& own,
                                           std::span<const MaterialRegion> regions);

// Each material within its ranges, and what goes with what: beside one that springs must step, as is_plainly_
// elastic() says, each has a Poisson's ratio that springs can have.
Status check_materials(const LatticeMaterials& materials);

// All of them.
bool are_plainly_elastic(const LatticeMaterials& materials);
double largest_youngs_modulus_pa(const LatticeMaterials& materials);
double least_poissons_ratio(const LatticeMaterials& materials);

}  // namespace spoonbill
