#include "engine/material/lattice_materials.h"

#include <algorithm>
#include <string>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Prefixes the message of an error with the region's index. The error's code and field do not change.
// `separator` is "." if the message begins with a field of the region, ": " otherwise.
Error in_region(std::size_t region, const std::string& separator, const Error& error) {
  return {error.code, "regions[" + std::to_string(region) + "]" + separator + error.message, error.field};
}

// Assigns the region's material to the cells whose centres it contains.
Status assign_material(const MaterialRegion& region, const LatticeMesh& mesh,
                       const std::vector<BodyCoordinates>& cells, LatticeMaterials& materials) {
  const auto number = static_cast<std::uint8_t>(materials.materials.size());
  materials.materials.push_back(*region.material);
  materials.material_index.resize(cells.size(), 0);
  bool contains_any = false;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!contains(region.region, cells[c])) continue;
    materials.material_index[c] = number;
    contains_any |= mesh.filled.empty() || mesh.filled[c];
  }
  if (contains_any) return {};
  return Error{
      ErrorCode::too_few,
      "contains no cell centre of the lattice; make the region larger or give the lattice more nodes"};
}

Status assign_friction(const MaterialRegion& region, const std::vector<BodyCoordinates>& nodes,
                       LatticeMaterials& materials) {
  const auto number = static_cast<std::uint8_t>(materials.frictions.size());
  materials.frictions.push_back(region.friction ? *region.friction : region.material->friction);
  materials.friction_index.resize(nodes.size(), 0);
  bool contains_any = false;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!contains(region.region, nodes[n])) continue;
    materials.friction_index[n] = number;
    contains_any |= nodes[n].depth_m == 0.0;
  }
  if (contains_any || !region.friction) return {};
  return Error{ErrorCode::too_few,
               "friction: the region contains no node of the surface; make the region larger or let its "
               "depth begin at 0",
               "friction"};
}

}  // namespace

Result<LatticeMaterials> lattice_materials(const LatticeMesh& mesh, const Material& own,
                                           std::span<const MaterialRegion> regions) {
  SPOONBILL_ASSERT(regions.size() < 256);
  LatticeMaterials materials(own);
  if (const Status status =
          check_range("regions", static_cast<int>(regions.size()), material_region_count_range);
      !status.ok()) {
    return status.error();
  }
  if (regions.empty()) return materials;
  const std::vector<BodyCoordinates> nodes = find_node_coordinates(mesh), cells = find_cell_coordinates(mesh);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (const Status status = check_material_region(regions[r]); !status.ok()) {
      return in_region(r, ".", status.error());
    }
    if (regions[r].material) {
      if (const Status status = assign_material(regions[r], mesh, cells, materials); !status.ok()) {
        return in_region(r, ": ", status.error());
      }
    }
    if (const Status status = assign_friction(regions[r], nodes, materials); !status.ok()) {
      return in_region(r, ".", status.error());
    }
  }
  return materials;
}

Status check_materials(const LatticeMaterials& materials) {
  SPOONBILL_ASSERT(!materials.materials.empty());
  for (const Material& material : materials.materials) {
    if (Status status = check_material(material); !status.ok()) return status;
  }
  if (are_linear_elastic(materials)) return {};
  for (const Material& material : materials.materials) {
    if (material.poissons_ratio >= min_spring_poissons_ratio) continue;
    return Error{ErrorCode::inconsistent,
                 "material " + material.name + ": poissons_ratio is " + number_text(material.poissons_ratio) +
                     ", must be " + number_text(min_spring_poissons_ratio) +
                     " or more in a body with a plastic, creeping or stiffening material",
                 "poissons_ratio"};
  }
  return {};
}

bool are_linear_elastic(const LatticeMaterials& materials) {
  return std::all_of(materials.materials.begin(), materials.materials.end(), is_linear_elastic);
}

double max_youngs_modulus_pa(const LatticeMaterials& materials) {
  SPOONBILL_ASSERT(!materials.materials.empty());
  double largest = 0.0;
  for (const Material& material : materials.materials) {
    largest = std::max(largest, material.youngs_modulus_pa);
  }
  return largest;
}

double min_poissons_ratio(const LatticeMaterials& materials) {
  SPOONBILL_ASSERT(!materials.materials.empty());
  double least = poissons_ratio_range.high;
  for (const Material& material : materials.materials) least = std::min(least, material.poissons_ratio);
  return least;
}

}  // namespace spoonbill
