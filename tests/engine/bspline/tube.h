// Closed bodies in the form of tubes: periodic in u and clamped in v. Each end is a pole, at which a whole
// ring of control points coincides.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Returns a surface near an ellipsoid with half-axes 0.02, 0.01 and 0.05 m around `centre`, with poles
// at z = +-0.05. It is smooth at the poles, because the rings beside them are in the tangent plane. du x dv
// points outward.
Surface ellipsoid_tube(int around, int along, const Vector3& centre = Vector3::Zero());

// Returns the surface with u and v exchanged, so that its poles are at the ends of u.
Surface transposed(const Surface& surface);

}  // namespace spoonbill
