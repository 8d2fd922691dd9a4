// Starting shapes with flat faces: the box with rounded edges, which a thin plate is too, and the open sheet.
// The origin is their middle.
#pragma once

#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

// Along x, y and z. Its ends are two faces opposite each other, those of its longest side unless they are
// slender; their middles are the poles. The rounding is that of the edges about the ends; the four edges
// between the ends have twice it, at most half the shortest side, and the corners are parts of tori.
struct BoxSize {
  Vector3 size_m{0.06, 0.04, 0.02};
  double rounding_m = 0.002;  // at most largest_box_rounding_share of the shortest side
};
inline constexpr double largest_box_rounding_share = 0.4;
Result<ExactShape> box_shape(const BoxSize& size);
double usual_rounding_m(const BoxSize& size);

// A closed slab that lies level, its poles in the middles of its faces, its rim half round.
struct PlateSize {
  double x_size_m = 0.1, z_size_m = 0.06, thickness_m = 0.003;
  double corner_m = 0.006;  // the radius of its four corners, seen from above: at least the thickness
};
Result<ExactShape> plate_shape(const PlateSize& size);
double usual_corner_m(const PlateSize& size);

// Open both ways and level: u along x, v against z, so that its normals point up.
Result<ExactShape> sheet_shape(double x_size_m, double z_size_m);

}  // namespace spoonbill
