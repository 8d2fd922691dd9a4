// B-spline basis functions, blossoms and derivative bounds for one parameter direction.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/bspline/knot_vector.h"

namespace spoonbill {

inline constexpr int max_basis_derivative = 2;

// The nonzero basis functions of one knot span and their derivatives. values[d][j] is the d-th derivative of
// the j-th nonzero basis function of `span`, j = 0..degree.
struct BasisFunctions {
  int span = 0;
  std::array<std::array<double, max_degree + 1>, max_basis_derivative + 1> values{};
};

// Returns the nonzero basis functions at u, which must be in the domain (Eq. 2 of Pungotra et al. 2013; Piegl
// and Tiller 1997, algorithm A2.3). A span includes its start but not its end; only the last span includes
// both. Derivatives of an order above the degree are zero. Does not allocate.
BasisFunctions basis_functions(const KnotVector& knots, double u);

// Computes only the span and values[0], with the same bits as basis_functions().
void basis_values(const KnotVector& knots, double u, BasisFunctions& basis);

// Weights of a span's control points in the order of KnotVector::control_index(); their sum is 1.
using BlossomWeights = std::array<double, max_degree + 1>;

// Returns the blossom of a polynomial piece at the arguments, as weights of the piece's control points. The
// blossom is the symmetric multi-affine function that equals the polynomial where all arguments are equal.
// Its values at `degree` consecutive knots are control points; this property is used to convert between knot
// vectors (Ramshaw 1989). `span` is a result of find_span(). The number of arguments must be from the degree
// to max_degree. If there are more arguments than the degree, the blossom is that of the same polynomial
// raised to the higher degree: the mean of the original blossom over all subsets with as many arguments as
// the original degree. Does not allocate.
BlossomWeights blossom(const KnotVector& knots, int span, std::span<const double> arguments);

// Parallel lines of control points. The next point of a line is `along` elements further in memory, the next
// line `across` elements.
template <class Real>
struct ControlLines {
  const Real* x;
  const Real* y;
  const Real* z;
  int along;
  int lines;
  int across;
};

// Bound of a surface's first derivative in one direction. The bound is the length of the derivative's longest
// control vector. A control vector is degree * (P[i+1] - P[i]) / (knot[i+degree+1] - knot[i+1]) (Piegl and
// Tiller 1997, section 3.3). Immutable once made; any thread may read it.
class DerivativeBound {
 public:
  explicit DerivativeBound(const KnotVector& knots);

  // Returns the bound in metres for a parameter scaled to a domain of length 1.
  template <class Real>
  double longest(const ControlLines<Real>& net) const;

 private:
  struct Step {
    int from, to;
    double factor;
  };
  std::vector<Step> steps_;
};

extern template double DerivativeBound::longest(const ControlLines<float>&) const;
extern template double DerivativeBound::longest(const ControlLines<double>&) const;

}  // namespace spoonbill
