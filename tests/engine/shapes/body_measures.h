// Measures of a stock shape that are independent of the code that made it.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

inline constexpr double shape_tolerance_m = 1e-5;

// The volume inside and the area, by Gauss quadrature over the polynomial pieces: the volume exactly.
double volume_m3(const Surface& surface);
double area_m2(const Surface& surface);

// The largest magnitude of `distance` at random parameters.
double largest_distance_m(const Surface& surface, const std::function<double(const Vector3&)>& distance);

// The smallest cosine between the normal and the gradient of `distance`, at random parameters.
double least_outward(const Surface& surface, const std::function<double(const Vector3&)>& distance);

// The longest over the shortest step between rings at the same distance along v, and between points of a ring
// in its middle: 1 where parameters are spread by length.
struct Evenness {
  double along = 0.0, around = 0.0;
};
Evenness evenness(const Surface& surface);

// The largest jump of position, and of the first two derivatives over their largest size, across the seam of
// u.
double seam_jump(const Surface& surface);

// Returns true if elements that are not neighbours intersect. Uses coarse levels only: the finer ones take
// seconds on flat faces.
bool is_self_intersecting(const Surface& surface, bool closed);

FittedShape fitted(const Result<ExactShape>& shape, const ShapeFit& fit = {});

}  // namespace spoonbill
