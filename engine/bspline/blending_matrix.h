// Blending matrices of one direction and their inverses. A blending matrix A has a row for each parameter and
// a column for each control point, so that samples = A * control points (Eq. 4 of Pungotra et al. 2013). It
// depends on knots, degree and parameters, never on control points. All functions are pure, may be called
// from any thread, and are too slow for a tick.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// A banded matrix. Row i has bandwidth = degree + 1 entries from column first[i] on. Columns wrap around
// modulo `columns` in a periodic direction; a column may then occur more than once in a row, and its entries
// add up.
struct BlendingMatrix {
  int rows = 0;
  int columns = 0;
  int bandwidth = 0;
  std::vector<int> first;      // first column of each row, before wrapping
  std::vector<double> values;  // entries of the band: rows * bandwidth, row-major

  // Returns the column of entry k of a row.
  int column(int row, int k) const { return (first[row] + k) % columns; }
  // Returns the matrix in dense form (rows x columns).
  Eigen::MatrixXd dense() const;
};

// Returns the blending matrix of the basis functions' derivatives of the given order, 0 to 2, at the
// parameters. A parameter outside the domain is wrapped (periodic) or clamped (open).
BlendingMatrix blending_matrix(const KnotVector& knots, std::span<const double> parameters,
                               int derivative_order);

// Returns an error unless each control point has a sample of its own where its basis function is not zero
// (the condition of Schoenberg and Whitney 1953, wrapped for periodic directions). In an open direction the
// samples then determine the control points; in a periodic direction they may still not determine them (see
// pseudo_inverse()). The error names the first control point without such a sample.
Status check_schoenberg_whitney(const KnotVector& knots, std::span<const double> parameters);

// Returns the pseudo-inverse A^+ (columns x rows) by QR; never by inverting A^T A, which squares the
// condition number. Refuses samples that do not determine the control points: fewer samples than control
// points, a gap (see check_schoenberg_whitney()), or a singular periodic sampling. For evenly spaced periodic
// knots, a sampling is singular if there are as many samples as control points, their number is even, and an
// even degree is sampled at the knots or an odd degree midway between them.
Result<Eigen::MatrixXd> pseudo_inverse(const KnotVector& knots, std::span<const double> parameters);

// Constraints of a fit in one direction.
struct RefitConstraints {
  // One flag for each column of control points: 1 for a fixed column, otherwise 0. Empty if no column is
  // fixed.
  std::vector<std::uint8_t> fixed_columns;
  // True if the first or the last sample, respectively, is interpolated, so that a pole stays a pole. The
  // knots must be clamped there.
  bool keep_first = false, keep_last = false;
};

// Returns the matrix that computes control points (rows) from samples (columns) under constraints. Rows of
// fixed control points are zero. Rows of interpolated ends copy their sample. All other rows are A_free^+ (1
// - A_ends S). A_free and A_ends are the columns of the blending matrix for the free and for the interpolated
// control points, and S selects the samples at the interpolated ends. Without constraints the result is
// pseudo_inverse(). Refuses samples that do not determine the control points.
Result<Eigen::MatrixXd> constrained_inverse(const KnotVector& knots, std::span<const double> parameters,
                                            const RefitConstraints& constraints);

// Returns the least-squares inverse (A^T A)^-1 A^T of a tall matrix by QR, with the same bits on every
// machine; nothing if the columns of A are linearly dependent or outnumber the rows.
std::optional<Eigen::MatrixXd> least_squares_inverse(const Eigen::MatrixXd& matrix);

}  // namespace spoonbill
