#include "engine/material/lattice_report.h"

#include "engine/base/assert.h"

namespace spoonbill {

void LatticeReport::add(double volume_m3, const AchievedElasticity& achieved, double wanted_modulus_pa,
                        double wanted_ratio) {
  SPOONBILL_ASSERT(volume_m3 > 0.0 && wanted_modulus_pa > 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    youngs_modulus_ratio[axis] += volume_m3 * achieved.youngs_modulus_pa[axis] / wanted_modulus_pa;
    poissons_ratio[axis] += volume_m3 * achieved.poissons_ratio[axis];
  }
  wanted_poissons_ratio += volume_m3 * wanted_ratio;
}

void LatticeReport::divide_by(double volume_m3) {
  SPOONBILL_ASSERT(volume_m3 > 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    youngs_modulus_ratio[axis] /= volume_m3;
    poissons_ratio[axis] /= volume_m3;
  }
  wanted_poissons_ratio /= volume_m3;
}

}  // namespace spoonbill
