// Surfaces of every kind that can be exported to CAD, and the distance between two surfaces.
#pragma once

#include <string>
#include <vector>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

// A test surface. The surfaces are open sheets, clamped or not, of degrees 1 to 5; periodic tubes with and
// without poles; and closed bodies, a merged spoon among them.
struct KnownSurface {
  CadSurface surface;
  bool closes = false;
};
std::vector<KnownSurface> known_surfaces();

// Returns a surface about z that is periodic in both directions, with normals outward.
Surface torus_like(double ring_m, double tube_m);

// Returns the largest distance between points of the two surfaces at equal parameters.
double largest_distance_m(const Surface& a, const Surface& b);

// Returns the enclosed volume by the divergence theorem, with Gauss quadrature that is exact for polynomial
// pieces of degrees up to 5.
double volume_by_quadrature_m3(const Surface& surface);
double area_by_quadrature_m2(const Surface& surface);

}  // namespace spoonbill
