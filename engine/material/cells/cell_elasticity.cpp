#include "engine/material/cells/cell_elasticity.h"

#include <Eigen/LU>

#include "engine/base/assert.h"

namespace spoonbill {

AchievedElasticity compute_elasticity(const Eigen::Matrix3d& normal_stiffness_pa) {
  const Eigen::Matrix3d compliance = normal_stiffness_pa.inverse();
  AchievedElasticity result;
  for (int axis = 0; axis < 3; ++axis) {
    result.youngs_modulus_pa[axis] = 1.0 / compliance(axis, axis);
    const double lateral = compliance.col(axis).sum() - compliance(axis, axis);
    result.poissons_ratio[axis] = -0.5 * lateral / compliance(axis, axis);
  }
  return result;
}

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
