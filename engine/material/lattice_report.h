// What a body's cells achieve of the wanted elasticity. Plain data.
#pragma once

#include "engine/material/cells/achieved_elasticity.h"

namespace spoonbill {

// A mean over the cells by volume.
struct LatticeReport {
  double youngs_modulus_ratio[3] = {};  // achieved over wanted, along x, y, z
  double poissons_ratio[3] = {};
  double wanted_poissons_ratio = 0.0;
  double worst_cell_misfit = 0.0;  // see CellSprings::misfit
  double worst_jacobian = 1.0;     // see smallest_jacobian_ratio()

  // Sums first, cell by cell.
  void add(double volume_m3, const AchievedElasticity& achieved, double wanted_modulus_pa,
           double wanted_ratio);
  // Then means.
  void divide_by(double volume_m3);
};

}  // namespace spoonbill
