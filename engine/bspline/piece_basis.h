// The basis functions of a knot vector as the polynomials that they are between two knots, for evaluating one
// point after another: no division, and no recursion.
#pragma once

#include <array>
#include <vector>

#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Immutable once made, so any thread may ask; allocates only when made. Values agree with basis_functions()
// to rounding, not to the bit.
class PieceBasis {
 public:
  explicit PieceBasis(const KnotVector& knots);

  struct Values {
    const int* controls = nullptr;  // degree + 1 indices of control points
    // value[d][j]: the d-th derivative of the basis function of controls[j].
    std::array<std::array<double, 12>, 3> value;
  };
  // u must lie in the domain.
  void take(double u, Values& values) const;
  void take_values_only(double u, Values& values) const;

  const KnotVector& knots() const { return *knots_; }
  int degree() const { return degree_; }

 private:
  int piece_of(double u) const;

  const KnotVector* knots_;
  int degree_, padded_;  // padded_: degree + 1 rounded up to whole vectors
  std::vector<double> breaks_;
  double pieces_a_unit_;
  std::vector<double> scales_;  // dx / du of each piece, see coefficients_
  std::vector<int> controls_;   // degree + 1 of each piece
  // Of each piece, in x = -1..1 across it: degree + 1 rows of padded_ coefficients, of the highest power
  // first.
  std::vector<double> coefficients_;
};

// A surface beside the polynomials of its knots. A view: what it names must outlive it.
struct PiecewiseSurface {
  const Surface* surface;
  const PieceBasis* u;
  const PieceBasis* v;
};

// As evaluate(), position() and unit_normal() of the surface, to rounding.
SurfacePoint evaluate(const PiecewiseSurface& surface, double u, double v);
Vector3 position(const PiecewiseSurface& surface, double u, double v);
// At a point that evaluate() gave for u, v.
Vector3 unit_normal(const PiecewiseSurface& surface, const SurfacePoint& at, double u, double v);

}  // namespace spoonbill
