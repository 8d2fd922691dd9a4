// Blending matrices: the basis functions of one direction at given parameters, as a banded matrix A with one
// row a parameter and one column a control point, so that samples = A * control points (Eq. 4 of Pungotra et
// al. 2013). They depend on knots, degree and parameters, never on control points.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Row i holds bandwidth = degree + 1 entries from column first[i] on; columns wrap around (modulo columns)
// where the direction is periodic, and a column may then appear more than once in a row: entries add up.
struct BlendingMatrix {
  int rows = 0;
  int columns = 0;
  int bandwidth = 0;
  std::vector<int> first;      // rows
  std::vector<double> values;  // rows * bandwidth, row-major

  int column(int row, int k) const { return (first[row] + k) % columns; }
  Eigen::MatrixXd dense() const;
};

// The derivative_order-th derivatives (0 to 2) of the basis functions at the parameters. A parameter outside
// the domain is wrapped (periodic) or clamped (open).
BlendingMatrix blending_matrix(const KnotVector& knots, std::span<const double> parameters,
                               int derivative_order);

// Whether samples at the parameters determine every control point (Schoenberg and Whitney 1953, wrapped for
// periodic directions). The message names the first control point without a sample of its own.
Status check_schoenberg_whitney(const KnotVector& knots, std::span<const double> parameters);

// The pseudo-inverse A^+ (columns x rows) by QR; never by inverting A^T A, which squares the condition
// number. Refused when the samples do not determine the control points: fewer rows than columns, a gap, or
// one of the periodic traps (even count, even degree sampled at knots or odd degree at mid-spans, as many
// samples as control points).
Result<Eigen::MatrixXd> pseudo_inverse(const KnotVector& knots, std::span<const double> parameters);

}  // namespace spoonbill
