// Basis functions as one polynomial for each knot span. They serve to evaluate single points fast, without
// division and recursion.
#pragma once

#include <array>
#include <vector>

#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// The basis functions of a knot vector as polynomials. The knot vector must outlive the object. Allocates
// only when constructed; immutable afterwards, so that any thread may read it. Values equal those of
// basis_functions() except for rounding.
class PieceBasis {
 public:
  explicit PieceBasis(const KnotVector& knots);

  struct Values {
    const int* controls = nullptr;  // degree + 1 indices of control points
    // value[d][j] is the d-th derivative of the basis function of controls[j].
    std::array<std::array<double, 12>, 3> value;
  };
  // Computes the values and the first and second derivatives at u, which must be in the domain.
  void evaluate(double u, Values& values) const;

  // Computes only value[0] at u, which must be in the domain.
  void evaluate_values(double u, Values& values) const;

  const KnotVector& knots() const { return *knots_; }
  int degree() const { return degree_; }

 private:
  int find_piece(double u) const;

  const KnotVector* knots_;
  int degree_, padded_;  // padded_ is degree + 1, rounded up to whole SIMD vectors
  std::vector<double> breaks_;
  double pieces_a_unit_;
  std::vector<double> scales_;  // dx / du of each piece; see coefficients_ for x
  std::vector<int> controls_;   // degree + 1 indices of control points for each piece
  // Polynomial coefficients of each piece, in a variable x that runs from -1 to 1 across the piece: degree +
  // 1 rows of padded_ values, highest power first.
  std::vector<double> coefficients_;
};

// A surface and the polynomials of its knot vectors. A view: the referenced objects must outlive it.
struct PiecewiseSurface {
  const Surface* surface;
  const PieceBasis* u;
  const PieceBasis* v;
};

// Returns the same as the function of this name for a Surface, except for rounding.
SurfacePoint evaluate(const PiecewiseSurface& surface, double u, double v);
Vector3 position(const PiecewiseSurface& surface, double u, double v);
// Returns the position at the parameters u and v, given the results of evaluate_values() there.
Vector3 position(const PiecewiseSurface& surface, const PieceBasis::Values& u, const PieceBasis::Values& v);
// Returns true if u or v is at an end of the domain of an open direction.
bool is_on_edge(const PiecewiseSurface& surface, double u, double v);
// Returns the unit normal of the surface at u, v. `at` must be the result of evaluate() at u, v.
Vector3 unit_normal(const PiecewiseSurface& surface, const SurfacePoint& at, double u, double v);

}  // namespace spoonbill
