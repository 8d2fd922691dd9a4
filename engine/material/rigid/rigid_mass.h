// Mass of a rigid body and how it is distributed. Computed outside the tick.
#pragma once

#include <optional>

#include "engine/base/geometry.h"
#include "engine/scene/body.h"

namespace spoonbill {

struct RigidMass {
  double mass_kg = 0.0;
  Vector3 centre_m = Vector3::Zero();                       // centre of mass
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  // inertia tensor about the centre of mass
};

// Returns the mass of a body of one material: a shell, or the solid that its closed surface or its mesh
// bounds. Exact up to rounding for a solid, because the integrands are polynomials. Returns nothing for a
// solid with trims, and if the mass or an inertia is not positive.
std::optional<RigidMass> compute_rigid_mass(const Body& body);

}  // namespace spoonbill
