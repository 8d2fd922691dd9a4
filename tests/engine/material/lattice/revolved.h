// Bodies of revolution about z for the tests of lattices, and what they hold.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

struct MeridianPlace {
  double radius_m, height_m;
};

// A tube whose poles are the ends of the meridian, given over a share from 0, the lower pole, to 1; smooth
// pieces of least squares over 32 control points. Its middle line leans over x by `lean_m` at the height of
// the upper pole, as the square of the height over the lower one.
Surface revolved(const std::function<MeridianPlace(double)>& meridian, double lean_m = 0.0);

// A sphere about the origin, to 1e-4 of its radius.
Surface round_ball(double radius_m);

// The volume inside by the divergence theorem, over flat triangles of a fine grid.
double enclosed_volume_m3(const Surface& surface);

double volume_of(const LatticeMesh& mesh);

}  // namespace spoonbill
