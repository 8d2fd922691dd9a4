// How long the first derivative of a surface can be along one direction. The derivative is a B-spline itself,
// one degree lower, and lies within its control points: degree (P[i+1] - P[i]) / (knot[i+degree+1] -
// knot[i+1]) (Piegl and Tiller 1997, section 3.3). Immutable once made; any thread may read it.
#pragma once

#include <vector>

#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Lines of control points: the next point of a line is `along` further, the next line `across`.
template <class Real>
struct ControlLines {
  const Real* x;
  const Real* y;
  const Real* z;
  int along;
  int lines;
  int across;
};

class DerivativeBound {
 public:
  explicit DerivativeBound(const KnotVector& knots);

  // Metres, by the parameter scaled to a domain of length one.
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
