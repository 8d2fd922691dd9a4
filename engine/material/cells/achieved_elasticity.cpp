#include "engine/material/cells/achieved_elasticity.h"

#include <Eigen/LU>

namespace spoonbill {

AchievedElasticity elasticity_of(const Eigen::Matrix3d& normal_stiffness_pa) {
  const Eigen::Matrix3d compliance = normal_stiffness_pa.inverse();
  AchievedElasticity result;
  for (int axis = 0; axis < 3; ++axis) {
    result.youngs_modulus_pa[axis] = 1.0 / compliance(axis, axis);
    const double lateral = compliance.col(axis).sum() - compliance(axis, axis);
    result.poissons_ratio[axis] = -0.5 * lateral / compliance(axis, axis);
  }
  return result;
}

}  // namespace spoonbill
