// The skin of a body in a box of cells that bears its pressure.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Of the samples of make_skin() so many that none is further from the next than two thirds of a cell's shortest
// edge where they are so near, and eight a direction at least: what is left out of a round body are slivers
// of its volume. `place_at` tells where on the surface (u, v) is. Its points lie in filled cells where
// those samples do.
BodySkin body_skin(const Surface& surface, const LatticeMesh& box,
                   const std::function<BodyCoordinates(double u, double v)>& place_at);

}  // namespace spoonbill
