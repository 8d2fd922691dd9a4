// Volumes between a point and strips of a surface, which add up to a body's volume by the divergence theorem.
#pragma once

#include <span>
#include <vector>

#include "engine/bspline/surface.h"

namespace spoonbill {

// Returns, in m^3, the volume between `apex_m` and each strip of the surface between consecutive values of v.
// It is positive where the normals (along du x dv) point away from the apex. The values must increase. The
// quadrature is exact up to degree 3 in each direction; its operations round alike on every processor.
std::vector<double> compute_strip_volumes_m3(const Surface& surface, std::span<const double> v,
                                             const Vector3& apex_m);

// Returns the volume in m^3 that a closed surface encloses; negative if its normals point inward.
double compute_closed_volume_m3(const Surface& surface);

}  // namespace spoonbill
