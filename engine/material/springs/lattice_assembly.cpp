#include "engine/material/springs/lattice_assembly.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/material/cells/cell_springs.h"

namespace spoonbill {
namespace {

// Of the shear modulus: what is crushed holds its volume as a material of Poisson's ratio 0.45 does.
constexpr double crushed_share = 8.0;
constexpr float noise_share = 1e-4f;

}  // namespace

SpringLattice::Assembly::Assembly(const SpringLattice& of) {
  const LatticeMaterials& made_of = of.materials();
  for (const Material& material : made_of.materials) {
    const bool is_own = &material == &made_of.own();
    const double youngs =
        is_own ? of.youngs_modulus_pa()
               : material.youngs_modulus_pa * of.youngs_modulus_pa() / made_of.own().youngs_modulus_pa;
    // Below, a core moves the lattice, and its springs rest.
    const double poisson = std::max(material.poissons_ratio, min_spring_poissons_ratio);
    materials.push_back({youngs, shear_modulus(youngs, poisson), bulk_stiffness(youngs, poisson)});
  }
  const std::vector<double> none(static_cast<std::size_t>(of.mesh().node_count()), 0.0);
  mass = cell_count = none;
  stiffness.fill(none);
  if (made_of.are_several()) by_material.assign(materials.size(), stiffness);
}

std::size_t SpringLattice::Assembly::leading_material(int direction, std::size_t node) const {
  std::size_t leading = 0;
  const auto given = [&](std::size_t material) {
    return by_material[material][static_cast<std::size_t>(direction)][node];
  };
  for (std::size_t m = 1; m < by_material.size(); ++m) {
    if (given(m) > given(leading)) leading = m;
  }
  return leading;
}

void SpringLattice::assemble(Assembly& sum) {
  total_mass_ = rest_volume_ = 0.0;
  report_ = {};
  for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh_.count[2]; ++k) add_cell(i, j, k, sum);
    }
  }
  report_.divide_by(rest_volume_);
  if (!materials_.are_several()) total_mass_ = material().density_kg_per_m3 * rest_volume_;
  join_nodes(sum);
  store_nodes(sum);
  for (int d = 0; d < lattice_direction_count; ++d) store_springs(d, sum);
  store_stiffening(sum);
  store_flow_and_creep(sum);
}

void SpringLattice::add_cell(int i, int j, int k, Assembly& sum) {
  const CellCorners corners = mesh_.cell(i, j, k);
  const std::size_t made_of = materials_.index_of(mesh_.cell_index(i, j, k));
  const Assembly::Stiffness& material = sum.materials[made_of];
  const double density = materials_.materials[made_of].density_kg_per_m3;
  const CellSprings springs = cell_springs(corners, material.shear_pa);
  // Mass and stiffness by the same share: what vibrates in a part of a cell is no faster than the whole.
  const double share = mesh_.share(i, j, k), volume_m3 = share * springs.volume_m3;
  const auto node_of = [&](int corner) {
    return mesh_.index(i + (corner >> 2 & 1), j + (corner >> 1 & 1), k + (corner & 1));
  };
  for (int s = 0; s < cell_spring_count; ++s) {
    int from = cell_spring_corners[s][0], to = cell_spring_corners[s][1];
    const auto step = [&](int bit) { return (to >> bit & 1) - (from >> bit & 1); };
    int d = direction_of(step(2), step(1), step(0));
    if (d < 0) {
      std::swap(from, to);
      d = direction_of(step(2), step(1), step(0));
    }
    const auto direction = static_cast<std::size_t>(d), node = static_cast<std::size_t>(node_of(from));
    sum.stiffness[direction][node] += share * springs.stiffness_n_per_m[s];
    if (sum.by_material.empty()) continue;
    sum.by_material[made_of][direction][node] += share * springs.stiffness_n_per_m[s];
  }
  for (int c = 0; c < 8; ++c) {
    const auto node = static_cast<std::size_t>(node_of(c));
    sum.mass[node] += density * volume_m3 / 8.0;
    sum.cell_count[node] += 1.0;
  }
  const int first = node_of(0);
  bulk_[first] = static_cast<float>(material.bulk_pa * volume_m3);
  crushed_[first] = static_cast<float>(crushed_share * material.shear_pa * volume_m3);
  inverse_volume_[first] = static_cast<float>(1.0 / springs.volume_m3);
  has_cell_[first] = 1.0f;
  rest_volume_ += volume_m3;
  total_mass_ += density * volume_m3;
  report_.add(volume_m3, achieved_elasticity(corners, springs, material.bulk_pa), material.youngs_modulus_pa,
              materials_.materials[made_of].poissons_ratio);
  report_.worst_cell_misfit = std::max(report_.worst_cell_misfit, springs.misfit);
  report_.worst_jacobian = std::min(report_.worst_jacobian, smallest_jacobian_ratio(corners));
}

// The first of a seam's pair has the mass of both.
void SpringLattice::join_nodes(Assembly& sum) {
  for (std::size_t s = 0; s < seam_.size(); s += 2) {
    const auto first = static_cast<std::size_t>(seam_[s]), second = static_cast<std::size_t>(seam_[s + 1]);
    sum.mass[first] += sum.mass[second];
    sum.mass[second] = 0.0;
    sum.cell_count[first] += sum.cell_count[second];
    sum.cell_count[second] = sum.cell_count[first];
  }
}

void SpringLattice::store_nodes(const Assembly& sum) {
  for (std::size_t n = 0; n < sum.mass.size(); ++n) {
    node_mass_[n] = static_cast<float>(sum.mass[n]);
    inverse_cell_count_[n] = static_cast<float>(1.0 / sum.cell_count[n]);
    power_noise_[n] = noise_share * mixed(static_cast<std::uint32_t>(mesh_.joined(static_cast<int>(n))) + 1) /
                      std::sqrt(static_cast<float>(total_mass_));
  }
}

void SpringLattice::store_springs(int d, const Assembly& sum) {
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const std::array<int, 3> at = mesh_.place(n);
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int to = at[axis] + direction_step[d][axis];
      inside = inside && to >= 0 && to < mesh_.count[axis];
    }
    if (!inside) continue;
    const Vector3 rest = mesh_.nodes[n + offset_[d]] - mesh_.nodes[n];
    rest_x_[d][n] = static_cast<float>(rest.x());
    rest_y_[d][n] = static_cast<float>(rest.y());
    rest_z_[d][n] = static_cast<float>(rest.z());
    rest_length_[d][n] = static_cast<float>(rest.norm());
    first_rest_length_[d][n] = rest_length_[d][n];
    stiffness_[d][n] =
        static_cast<float>(sum.stiffness[static_cast<std::size_t>(d)][static_cast<std::size_t>(n)]);
  }
}

}  // namespace spoonbill
