// The elasticity that a cell has, whatever it is made of. Plain data.
#pragma once

#include <Eigen/Core>

#include "engine/base/geometry.h"

namespace spoonbill {

// Along x, y and z.
struct AchievedElasticity {
  Vector3 youngs_modulus_pa;
  Vector3 poissons_ratio;  // mean of the two lateral ratios for tension along each axis
};

// From the stress along each axis, Pa, by the strain along each, the others held.
AchievedElasticity elasticity_of(const Eigen::Matrix3d& normal_stiffness_pa);

}  // namespace spoonbill
