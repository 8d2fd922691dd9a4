#include "engine/bspline/stretch_bound.h"

#include <cmath>

#include "engine/base/assert.h"
#include "engine/bspline/derivative_bound.h"

namespace spoonbill {

double longest_stretch_m(const Surface& surface) {
  SPOONBILL_ASSERT(has_size_of_knots(surface));
  const ControlNet& net = surface.net;
  const ControlLines<double> in_u{net.x.data(), net.y.data(), net.z.data(), net.columns, net.columns, 1};
  const ControlLines<double> in_v{net.x.data(), net.y.data(), net.z.data(), 1, net.rows, net.columns};
  return std::hypot(DerivativeBound(surface.u).longest(in_u), DerivativeBound(surface.v).longest(in_v));
}

}  // namespace spoonbill
