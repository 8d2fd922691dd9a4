// Surfaces for the tests of thin shells, as near to closed forms as cubic pieces come.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// a x b over x and z, flat at y = 0, its normal up or down.
Surface flat_sheet(double a_m, double b_m, bool up = true);

// A part of a sphere about the origin, open towards +y: from the pole at the bottom to `opening_rad` from it;
// normals outward. Off by less than 1e-5 of the radius. The pole is at the start of v, or at its end.
Surface spherical_bowl(double radius_m, double opening_rad, bool pole_at_end = false);

// A cylinder about y, open at both ends, periodic in u, normals outward; its seam lies on the x axis, or that
// share of a turn from it.
Surface open_ring(double radius_m, double height_m, double seam_turn = 0.0);

// The same with u and v exchanged, and the normals outward still.
Surface open_ring_around_v(double radius_m, double height_m);

}  // namespace spoonbill
