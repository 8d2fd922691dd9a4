// Tubes as bodies are: periodic in u, clamped in v, ending in poles where a whole ring of control points
// coincides.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Near an ellipsoid with half-axes 0.02, 0.01 and 0.05 m around `centre`, its poles at z = +-0.05. The
// surface is smooth there: the rings beside the poles lie in the tangent plane. du x dv points outward.
Surface ellipsoid_tube(int around, int along, const Vector3& centre = Vector3::Zero());

// The same surface with the directions exchanged: poles at the ends of u.
Surface transposed(const Surface& surface);

}  // namespace spoonbill
