// The unit normal at any parameters, poles and collapsed edges included, from control points of either
// precision. Computes in double and allocates nothing.
#pragma once

#include "engine/base/pose.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Coordinates of a control net in metres, in the order of ControlNet.
template <class Real>
struct NetView {
  const Real* x;
  const Real* y;
  const Real* z;
  int columns;
};

// See unit_normal(Surface). u, v are wrapped or clamped into the domain.
template <class Real>
Vector3 unit_normal(const KnotVector& u_knots, const KnotVector& v_knots, const NetView<Real>& net, double u,
                    double v);

extern template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<float>&, double,
                                    double);
extern template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<double>&, double,
                                    double);

}  // namespace spoonbill
