// Measures stock shapes independently of the code that made them.
#pragma once

#include <functional>

#include "engine/bspline/surface.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

inline constexpr double shape_tolerance_m = 1e-5;

// volume_m3() returns the enclosed volume and area_m2() the area, by Gauss quadrature over the polynomial
// pieces. The volume is exact.
double volume_m3(const Surface& surface);
double area_m2(const Surface& surface);

// Returns the largest magnitude of `distance` at random points of the surface.
double largest_distance_m(const Surface& surface, const std::function<double(const Vector3&)>& distance);

// Returns the smallest cosine of the angle between the normal and the gradient of `distance`, at random
// points.
double least_outward(const Surface& surface, const std::function<double(const Vector3&)>& distance);

// Ratio of the longest to the shortest of the distances that equal parameter steps cover. `along` is for
// steps from ring to ring along v, `around` for steps along the ring halfway along v. Both are 1 if
// parameters are proportional to length.
struct Evenness {
  double along = 0.0, around = 0.0;
};
Evenness evenness(const Surface& surface);

// Returns the largest jump across the seam of u: of the position and of the first two derivatives, each
// relative to the length of the first derivative.
double seam_jump(const Surface& surface);

// Returns true if elements that are not neighbours intersect. Uses coarse levels only: the finer ones take
// seconds on flat faces.
bool is_self_intersecting(const Surface& surface, bool closed);

FittedShape fitted(const Result<ExactShape>& shape, const ShapeFit& fit = {});

}  // namespace spoonbill
