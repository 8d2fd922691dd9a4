// Provides surfaces for tests of thin shells, as close to closed forms as cubic pieces can be.
#pragma once

#include "engine/bspline/surface.h"

namespace spoonbill {

// Returns a flat sheet of a x b along x and z at y = 0, with its normal up or down.
Surface flat_sheet(double a_m, double b_m, bool up = true);

// Returns a part of a sphere about the origin that is open towards +y: from the pole at the bottom to the
// angle `opening_rad` from it, with normals outward. The deviation is less than 1e-5 of the radius. The pole
// is at the start of v, or at its end if `pole_at_end` is set.
Surface spherical_bowl(double radius_m, double opening_rad, bool pole_at_end = false);

// Returns a cylinder about y, open at both ends, periodic in u, with normals outward. Its seam is on the x
// axis, or `seam_turn` turns from it.
Surface open_ring(double radius_m, double height_m, double seam_turn = 0.0);

// Returns the ring of open_ring() with u and v exchanged and with normals still outward.
Surface open_ring_around_v(double radius_m, double height_m);

}  // namespace spoonbill
