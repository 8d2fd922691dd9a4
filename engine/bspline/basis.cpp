#include "engine/bspline/basis.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

using Table = std::array<std::array<double, max_degree + 1>, max_degree + 1>;

// table[j][r], r <= j: the basis functions of degree j. table[j][r], r > j: the knot differences they divide
// by.
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

// The derivatives of basis function r up to `highest`, without the factors degree! / (degree - k)!.
void derivatives_of_one(const Table& table, int degree, int r, int highest, BasisFunctions& basis) {
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
  for (int r = 0; r <= degree; ++r) derivatives_of_one(table, degree, r, highest, basis);
  double factor = 1.0;
  for (int k = 1; k <= highest; ++k) {
    factor *= degree - k + 1;
    for (int j = 0; j <= degree; ++j) basis.values[k][j] *= factor;
  }
  return basis;
}

}  // namespace spoonbill
