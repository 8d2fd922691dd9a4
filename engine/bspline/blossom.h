// The blossom of a polynomial piece: the function of as many arguments as the degree, symmetric and affine in
// each, that gives the polynomial where all are equal. At consecutive knots it gives control points, which is
// how one knot vector's control points come from another's (Ramshaw 1989).
#pragma once

#include <array>
#include <span>

#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Of the span's control points, in the order of KnotVector::control_index; they add up to 1.
using BlossomWeights = std::array<double, max_degree + 1>;

// `span` as find_span() gives it; as many arguments as the degree, or more, up to max_degree: then of the
// polynomial taken as one of that degree, the mean over the choices of so many arguments. Allocates nothing.
BlossomWeights blossom(const KnotVector& knots, int span, std::span<const double> arguments);

}  // namespace spoonbill
