#include "engine/bspline/least_squares.h"

#include <cmath>
#include <utility>
#include <vector>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

// Of the largest diagonal entry of R. Usable samplings up to degree 9 stay above 1e-8, the singular ones of
// periodic directions end near 1e-16.
constexpr double rank_tolerance = 1e-12;

// QR with column pivoting by Householder reflections. Written out, because the order of Eigen's sums depends
// on the processor's cache sizes, and the pseudo-inverse enters the state of the simulation.
struct PivotedQr {
  Eigen::MatrixXd q;       // orthonormal columns
  Eigen::MatrixXd r;       // upper triangle
  std::vector<int> order;  // column k of q r is column order[k] of the matrix
};

double ordered_dot(const double* a, const double* b, int count) {
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

// target -= reflector (reflector . target) 2 / |reflector|^2
void reflect(const double* reflector, double squared_norm, double* target, int count) {
  if (squared_norm == 0.0) return;
  const double factor = 2.0 * ordered_dot(reflector, target, count) / squared_norm;
  for (int i = 0; i < count; ++i) target[i] -= factor * reflector[i];
}

int longest_column(const Eigen::MatrixXd& matrix, int k) {
  const int rows = static_cast<int>(matrix.rows());
  int longest = k;
  double longest_norm = -1.0;
  for (int column = k; column < matrix.cols(); ++column) {
    const double norm = ordered_dot(&matrix(k, column), &matrix(k, column), rows - k);
    if (norm > longest_norm) {
      longest = column;
      longest_norm = norm;
    }
  }
  return longest;
}

void swap_columns(Eigen::MatrixXd& matrix, int a, int b) {
  for (int i = 0; a != b && i < matrix.rows(); ++i) std::swap(matrix(i, a), matrix(i, b));
}

PivotedQr factorize(Eigen::MatrixXd matrix) {
  const int rows = static_cast<int>(matrix.rows()), columns = static_cast<int>(matrix.cols());
  PivotedQr qr;
  for (int column = 0; column < columns; ++column) qr.order.push_back(column);
  Eigen::MatrixXd reflectors = Eigen::MatrixXd::Zero(rows, columns);
  std::vector<double> squared_norms(static_cast<std::size_t>(columns));
  for (int k = 0; k < columns; ++k) {
    const int pivot = longest_column(matrix, k);
    swap_columns(matrix, k, pivot);
    std::swap(qr.order[k], qr.order[pivot]);
    double* const reflector = &reflectors(k, k);
    for (int i = k; i < rows; ++i) reflector[i - k] = matrix(i, k);
    const double norm = std::sqrt(ordered_dot(reflector, reflector, rows - k));
    reflector[0] += reflector[0] < 0.0 ? -norm : norm;
    squared_norms[k] = ordered_dot(reflector, reflector, rows - k);
    for (int column = k; column < columns; ++column) {
      reflect(reflector, squared_norms[k], &matrix(k, column), rows - k);
    }
  }
  qr.q = Eigen::MatrixXd::Zero(rows, columns);
  for (int k = 0; k < columns; ++k) qr.q(k, k) = 1.0;
  for (int k = columns - 1; k >= 0; --k) {
    for (int column = k; column < columns; ++column) {
      reflect(&reflectors(k, k), squared_norms[k], &qr.q(k, column), rows - k);
    }
  }
  qr.r = std::move(matrix);
  return qr;
}

Eigen::MatrixXd inverse_from(const PivotedQr& qr) {
  const int rows = static_cast<int>(qr.q.rows()), columns = static_cast<int>(qr.q.cols());
  Eigen::MatrixXd inverse(columns, rows);
  std::vector<double> solution(static_cast<std::size_t>(columns));
  for (int sample = 0; sample < rows; ++sample) {
    for (int k = columns - 1; k >= 0; --k) {
      double sum = qr.q(sample, k);
      for (int j = k + 1; j < columns; ++j) sum -= qr.r(k, j) * solution[j];
      solution[k] = sum / qr.r(k, k);
    }
    for (int k = 0; k < columns; ++k) inverse(qr.order[k], sample) = solution[k];
  }
  return inverse;
}

}  // namespace

std::optional<Eigen::MatrixXd> least_squares_inverse(const Eigen::MatrixXd& matrix) {
  SPOONBILL_ASSERT_DEBUG(matrix.allFinite());
  const Eigen::Index columns = matrix.cols();
  if (columns == 0 || matrix.rows() < columns) return std::nullopt;
  const PivotedQr qr = factorize(matrix);
  const double last = std::abs(qr.r(columns - 1, columns - 1));
  if (!(last > rank_tolerance * std::abs(qr.r(0, 0)))) return std::nullopt;
  return inverse_from(qr);
}

}  // namespace spoonbill
