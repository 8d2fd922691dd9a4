#include "engine/bspline/basis.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

using Table = std::array<std::array<double, max_degree + 1>, max_degree + 1>;

// Returns a table of basis functions and knot differences. Entry [r][j] is basis function r of degree j if r
// <= j. If r > j, it is a knot difference by which basis functions are divided.
Table triangular_table(const double* knots, int degree, double u) {
  Table table;
  std::array<double, max_degree + 1> left, right;
  table[0][0] = 1.0;
  for (int j = 1; j <= degree; ++j) {
    left[j] = u - knots[1 - j];
    right[j] = knots[j] - u;
    double saved = 0.0;
    for (int r = 0; r < j; ++r) {
      table[j][r] = right[r + 1] + left[j - r];
      const double quotient = table[r][j - 1] / table[j][r];
      table[r][j] = saved + right[r + 1] * quotient;
      saved = left[j - r] * quotient;
    }
    table[j][j] = saved;
  }
  return table;
}

// Computes the derivatives of basis function r up to order `highest`. The caller must multiply the derivative
// of order k by degree! / (degree - k)!.
void compute_derivatives(const Table& table, int degree, int r, int highest, BasisFunctions& basis) {
  std::array<std::array<double, max_degree + 1>, 2> rows;
  std::array<double, max_degree + 1>* current = &rows[0];
  std::array<double, max_degree + 1>* next = &rows[1];
  (*current)[0] = 1.0;
  for (int k = 1; k <= highest; ++k) {
    const int rk = r - k, pk = degree - k;
    double derivative = 0.0;
    if (r >= k) {
      (*next)[0] = (*current)[0] / table[pk + 1][rk];
      derivative = (*next)[0] * table[rk][pk];
    }
    const int first = rk >= -1 ? 1 : -rk;
    const int last = r - 1 <= pk ? k - 1 : degree - r;
    for (int j = first; j <= last; ++j) {
      (*next)[j] = ((*current)[j] - (*current)[j - 1]) / table[pk + 1][rk + j];
      derivative += (*next)[j] * table[rk + j][pk];
    }
    if (r <= pk) {
      (*next)[k] = -(*current)[k - 1] / table[pk + 1][r];
      derivative += (*next)[k] * table[r][pk];
    }
    basis.values[k][r] = derivative;
    std::swap(current, next);
  }
}

}  // namespace

void basis_values(const KnotVector& knots, double u, BasisFunctions& basis) {
  SPOONBILL_ASSERT_DEBUG(u >= knots.domain_start() && u <= knots.domain_end());
  const int degree = knots.degree();
  basis.span = knots.find_span(u);
  const double* at = knots.extended_knots().data() + basis.span;
  std::array<double, max_degree + 1>& values = basis.values[0];
  values[0] = 1.0;
  for (int j = 1; j <= degree; ++j) {
    double saved = 0.0;
    for (int r = 0; r < j; ++r) {
      const double right = at[r + 1] - u, left = u - at[1 - (j - r)];
      const double quotient = values[r] / (right + left);
      values[r] = saved + right * quotient;
      saved = left * quotient;
    }
    values[j] = saved;
  }
}

BasisFunctions basis_functions(const KnotVector& knots, double u) {
  SPOONBILL_ASSERT_DEBUG(u >= knots.domain_start() && u <= knots.domain_end());
  const int degree = knots.degree();
  BasisFunctions basis;
  basis.span = knots.find_span(u);
  const Table table = triangular_table(knots.extended_knots().data() + basis.span, degree, u);
  for (int j = 0; j <= degree; ++j) basis.values[0][j] = table[j][degree];

  const int highest = std::min(degree, max_basis_derivative);
  for (int r = 0; r <= degree; ++r) compute_derivatives(table, degree, r, highest, basis);
  double factor = 1.0;
  for (int k = 1; k <= highest; ++k) {
    factor *= degree - k + 1;
    for (int j = 0; j <= degree; ++j) basis.values[k][j] *= factor;
  }
  return basis;
}

namespace {

BlossomWeights blossom_of_own_degree(const KnotVector& knots, int span, std::span<const double> arguments) {
  const int degree = knots.degree();
  const auto& t = knots.extended_knots();
  std::array<BlossomWeights, max_degree + 1> points{};
  for (int j = 0; j <= degree; ++j) points[j][j] = 1.0;
  for (int r = 1; r <= degree; ++r) {
    for (int j = degree; j >= r; --j) {
      const double low = t[span - degree + j], high = t[span + 1 + j - r];
      const double fraction = (arguments[r - 1] - low) / (high - low);
      for (int k = 0; k <= degree; ++k) {
        points[j][k] = (1.0 - fraction) * points[j - 1][k] + fraction * points[j][k];
      }
    }
  }
  return points[degree];
}

}  // namespace

BlossomWeights blossom(const KnotVector& knots, int span, std::span<const double> arguments) {
  const int degree = knots.degree(), count = static_cast<int>(arguments.size());
  SPOONBILL_ASSERT(count >= degree && count <= max_degree);
  SPOONBILL_ASSERT(span >= degree && span + degree + 1 < static_cast<int>(knots.extended_knots().size()));
  SPOONBILL_ASSERT_DEBUG(knots.extended_knots()[span] < knots.extended_knots()[span + 1]);
  if (count == degree) return blossom_of_own_degree(knots, span, arguments);
  BlossomWeights mean{};
  int choices = 0;
  for (unsigned choice = 0; choice < 1u << count; ++choice) {
    if (std::popcount(choice) != degree) continue;
    std::array<double, max_degree> chosen{};
    int next = 0;
    for (int k = 0; k < count; ++k) {
      if ((choice >> k & 1u) != 0) chosen[next++] = arguments[k];
    }
    const BlossomWeights weights = blossom_of_own_degree(knots, span, std::span(chosen).first(degree));
    for (int j = 0; j <= degree; ++j) mean[j] += weights[j];
    ++choices;
  }
  for (double& weight : mean) weight /= choices;
  return mean;
}

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
    // A basis function of the derivative is zero everywhere if its support has no width.
    if (width == 0) continue;
    const double length = knots.domain_length();
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
