#include "engine/inspection/material_mix.h"

#include <numeric>
#include <set>

#include "engine/material/lattice/lattice_of.h"
#include "engine/material/lattice_materials.h"

namespace spoonbill {

namespace {

struct Sums {
  double volume_m3 = 0.0, mass_kg = 0.0;
  Vector3 volume_moment = Vector3::Zero(), mass_moment = Vector3::Zero();
};

Vector3 middle_of(const CellCorners& corners) {
  return std::accumulate(corners.begin(), corners.end(), Vector3(Vector3::Zero())) / 8.0;
}

}  // namespace

Result<MaterialMix> material_mix(const Body& body) {
  const auto mesh = lattice_of(body);
  if (!mesh) return mesh.error();
  const auto materials = lattice_materials(mesh.value(), body.material, body.regions);
  if (!materials) return materials.error();
  Sums sums;
  std::set<std::size_t> found;
  for (int k = 0; k + 1 < mesh->count[2]; ++k) {
    for (int i = 0; i + 1 < mesh->count[0]; ++i) {
      for (int j = 0; j + 1 < mesh->count[1]; ++j) {
        const CellCorners corners = mesh->cell(i, j, k);
        const double volume = mesh->share(i, j, k) * cell_volume(corners);
        if (!(volume > 0.0)) continue;
        const std::size_t material = materials->index_of(mesh->cell_index(i, j, k));
        const double mass = volume * materials->materials[material].density_kg_per_m3;
        found.insert(material);
        sums.volume_m3 += volume;
        sums.mass_kg += mass;
        sums.volume_moment += volume * middle_of(corners);
        sums.mass_moment += mass * middle_of(corners);
      }
    }
  }
  if (!(sums.volume_m3 > 0.0)) return Error{"its lattice has no volume"};
  MaterialMix mix;
  mix.density_kg_per_m3 = sums.mass_kg / sums.volume_m3;
  mix.from_middle_m = sums.mass_moment / sums.mass_kg - sums.volume_moment / sums.volume_m3;
  for (const std::size_t material : found) mix.materials.push_back(materials->materials[material].name);
  return mix;
}

}  // namespace spoonbill
