// Volumes between a point and strips of a surface. By the divergence theorem, the volumes of all strips of a
// closed surface add up to the volume of the body.
#pragma once

#include <span>
#include <vector>

#include "engine/bspline/surface.h"

namespace spoonbill {

// Divides the surface into strips between consecutive values of `v`, which must not decrease. Returns the
// volume in m^3 between `apex_m` and each strip, positive where the normals (along du x dv) point away from
// the apex. The quadrature is exact for surfaces of degree 3 or less in each direction, and gives the same
// bits on every processor.
std::vector<double> compute_strip_volumes_m3(const Surface& surface, std::span<const double> v,
                                             const Vector3& apex_m);

// Returns the volume in m^3 that a closed surface encloses; negative if its normals point inward.
double compute_closed_volume_m3(const Surface& surface);

}  // namespace spoonbill
