// Provides bodies of revolution about z for tests of lattices, and the volumes of surfaces and meshes.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

struct MeridianPlace {
  double radius_m, height_m;
};

// Returns a tube around z from its meridian, which is a function of a fraction from 0 at the lower pole to 1
// at the upper pole. The meridian is fitted by least squares with 32 control points. The centre line leans
// along x by `lean_m` at the upper pole; the lean grows with the square of the height above the lower pole.
Surface revolved(const std::function<MeridianPlace(double)>& meridian, double lean_m = 0.0);

// Returns a sphere about the origin, with an error of 1e-4 of its radius.
Surface round_ball(double radius_m);

// Returns the enclosed volume by the divergence theorem, summed over the flat triangles of a fine grid.
double enclosed_volume_m3(const Surface& surface);

double volume_of(const LatticeMesh& mesh);

}  // namespace spoonbill
