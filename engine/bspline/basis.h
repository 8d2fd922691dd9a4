// The nonzero basis functions of one span and their derivatives (Eq. 2 of Pungotra et al. 2013 in degree
// form, with half-open spans and the last one closed; the paper's closed spans make the sum 2 at knots).
#pragma once

#include <array>

#include "engine/bspline/knot_vector.h"

namespace spoonbill {

inline constexpr int max_basis_derivative = 2;

// values[d][j] is the d-th derivative of the j-th nonzero basis function of `span`, j = 0..degree.
struct BasisFunctions {
  int span = 0;
  std::array<std::array<double, max_degree + 1>, max_basis_derivative + 1> values{};
};

// u must lie in the domain. Derivatives above the degree are zero. Allocates nothing (Piegl and Tiller 1997,
// algorithm A2.3).
BasisFunctions basis_functions(const KnotVector& knots, double u);

// Their values alone, to the same bits: values[0], nothing else is set.
void basis_values(const KnotVector& knots, double u, BasisFunctions& basis);

}  // namespace spoonbill
