#include "engine/bspline/derivative_bound.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {

DerivativeBound::DerivativeBound(const KnotVector& knots) {
  SPOONBILL_ASSERT(knots.control_point_count() > 0);
  const std::vector<double>& extended = knots.extended_knots();
  const int degree = knots.degree(), last_span = static_cast<int>(extended.size()) - degree - 2;
  const auto control = [&](int basis) {
    const int span = std::clamp(basis, degree, last_span);
    return knots.control_index(span, basis - span + degree);
  };
  for (int basis = 0; basis < last_span; ++basis) {
    const double width = extended[basis + degree + 1] - extended[basis + 1];
    // Of width zero, it has no part of the domain.
    if (width == 0) continue;
    const double length = knots.domain_end() - knots.domain_start();
    steps_.push_back({control(basis), control(basis + 1), degree * length / width});
  }
}

template <class Real>
double DerivativeBound::longest(const ControlLines<Real>& net) const {
  Real longest_squared = 0;
  for (const Step& step : steps_) {
    const Real factor = static_cast<Real>(step.factor);
    for (int line = 0; line < net.lines; ++line) {
      const int from = step.from * net.along + line * net.across;
      const int to = step.to * net.along + line * net.across;
      const Real x = factor * (net.x[to] - net.x[from]);
      const Real y = factor * (net.y[to] - net.y[from]);
      const Real z = factor * (net.z[to] - net.z[from]);
      longest_squared = std::max(longest_squared, x * x + y * y + z * z);
    }
  }
  return std::sqrt(static_cast<double>(longest_squared));
}

template double DerivativeBound::longest(const ControlLines<float>&) const;
template double DerivativeBound::longest(const ControlLines<double>&) const;

}  // namespace spoonbill
