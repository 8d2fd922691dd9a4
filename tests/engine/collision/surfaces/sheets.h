// Surfaces whose contact has a closed form.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Returns y = bend_x x^2 + bend_z z^2 over -half_m to half_m in x and z, exactly, with degree 2; du x dv
// points up. v runs along x and u along z, both from 0 to 1.
Surface quadric_sheet(double half_m, double bend_x, double bend_z, int controls);

// Returns a tube about x from -half_length_m to half_length_m, round to 1e-9 of its radius. u goes around it,
// and du x dv points outwards.
Surface round_tube(double radius_m, double half_length_m);

// Returns a torus about y, round to 1e-8 of the tube's radius; du x dv points outwards.
Surface round_torus(double ring_radius_m, double tube_radius_m);

}  // namespace spoonbill
