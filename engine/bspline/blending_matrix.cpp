#include "engine/bspline/blending_matrix.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"

namespace spoonbill {

Eigen::MatrixXd BlendingMatrix::dense() const {
  SPOONBILL_ASSERT(first.size() == static_cast<std::size_t>(rows) &&
                   values.size() == first.size() * bandwidth);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < bandwidth; ++k) matrix(row, column(row, k)) += values[row * bandwidth + k];
  }
  return matrix;
}

BlendingMatrix blending_matrix(const KnotVector& knots, std::span<const double> parameters,
                               int derivative_order) {
  SPOONBILL_ASSERT(derivative_order >= 0 && derivative_order <= max_basis_derivative);
  SPOONBILL_ASSERT(knots.control_point_count() > 0);
  BlendingMatrix matrix;
  matrix.rows = static_cast<int>(parameters.size());
  matrix.columns = knots.control_point_count();
  matrix.bandwidth = knots.degree() + 1;
  matrix.first.reserve(parameters.size());
  matrix.values.reserve(parameters.size() * static_cast<std::size_t>(matrix.bandwidth));
  for (const double parameter : parameters) {
    const BasisFunctions basis = basis_functions(knots, knots.into_domain(parameter));
    matrix.first.push_back(knots.control_index(basis.span, 0));
    const auto& values = basis.values[derivative_order];
    matrix.values.insert(matrix.values.end(), values.begin(), values.begin() + matrix.bandwidth);
  }
  return matrix;
}

namespace {

// Smallest usable diagonal entry of R in a QR factorization, relative to the largest diagonal entry. For
// usable samplings up to degree 9 this ratio stays above 1e-8; for singular samplings of periodic directions
// it is about 1e-16.
constexpr double rank_tolerance = 1e-12;

// QR factorization with column pivoting by Householder reflections. Written by hand, because the order of
// Eigen's sums depends on the processor's cache sizes, and the pseudo-inverse enters the state of the
// simulation.
struct PivotedQr {
  Eigen::MatrixXd q;       // Q, with orthonormal columns
  Eigen::MatrixXd r;       // R, an upper triangle
  std::vector<int> order;  // column k of Q R is column order[k] of the matrix
};

double ordered_dot(const double* a, const double* b, int count) {
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

// Applies a Householder reflection: subtracts 2 (reflector . target) / |reflector|^2 times the reflector from
// the target.
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

Eigen::MatrixXd invert(const PivotedQr& qr) {
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
  return invert(qr);
}

namespace {

std::vector<double> sorted_distinct(const KnotVector& knots, std::span<const double> parameters) {
  std::vector<double> sorted;
  for (const double parameter : parameters) sorted.push_back(knots.into_domain(parameter));
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

// Returns true if the basis function that starts at extended knot i is positive at t. It is positive inside
// its support, and at an end of its support where it is 1, as at a clamped end.
bool supports(const KnotVector& knots, int i, double t) {
  const auto& extended = knots.extended_knots();
  const double start = extended[i], end = extended[i + knots.degree() + 1];
  if (t > start && t < end) return true;
  return (t == start && extended[i + knots.degree()] == start && start < end) ||
         (t == end && extended[i + 1] == end && start < end);
}

Error gap_error(const KnotVector& knots, int control, double start, double end) {
  return Error{ErrorCode::too_few, "control point " + std::to_string(control) + " of " +
                                       std::to_string(knots.control_point_count()) +
                                       " has no sample of its own between " + number_text(start) + " and " +
                                       number_text(end) + "; add samples there"};
}

Status check_open(const KnotVector& knots, const std::vector<double>& samples) {
  const auto& extended = knots.extended_knots();
  std::size_t next = 0;
  for (int i = 0; i < knots.control_point_count(); ++i) {
    const double end = extended[i + knots.degree() + 1];
    while (next < samples.size() && samples[next] < end && !supports(knots, i, samples[next])) ++next;
    if (next == samples.size() || !supports(knots, i, samples[next])) {
      return gap_error(knots, i, std::max(extended[i], knots.domain_start()),
                       std::min(end, knots.domain_end()));
    }
    ++next;
  }
  return {};
}

// Matches control points to samples in cyclic order, starting with control point 0 and sample `offset`; the
// numbering of samples continues from one period to the next. Returns the number of control points that were
// matched before the first one without a sample.
int count_matched(const KnotVector& knots, const std::vector<double>& samples, int offset) {
  const double period = knots.domain_length();
  const int count = static_cast<int>(samples.size());
  const auto position = [&](int sample) {
    const int wraps = sample >= 0 ? sample / count : (sample - count + 1) / count;
    return samples[static_cast<std::size_t>(sample - wraps * count)] + wraps * period;
  };
  const auto& extended = knots.extended_knots();
  int next = offset;
  for (int i = 0; i < knots.control_point_count(); ++i) {
    const double start = extended[i + knots.degree()];
    const double end = extended[i + 2 * knots.degree() + 1];
    while (position(next) <= start) ++next;
    if (position(next) >= end || next >= offset + count) return i;
    ++next;
  }
  return knots.control_point_count();
}

Status check_periodic(const KnotVector& knots, const std::vector<double>& samples) {
  int matched = 0;
  for (int offset = 0; offset < static_cast<int>(samples.size()) && matched < knots.control_point_count();
       ++offset) {
    matched = std::max(matched, count_matched(knots, samples, offset));
  }
  if (matched == knots.control_point_count()) return {};
  const auto& knot = knots.knots();
  const int end = (matched + knots.degree() + 1) % knots.control_point_count();
  return gap_error(knots, matched, knot[matched], knot[end]);
}

}  // namespace

Status check_schoenberg_whitney(const KnotVector& knots, std::span<const double> parameters) {
  const std::vector<double> samples = sorted_distinct(knots, parameters);
  return knots.is_periodic() ? check_periodic(knots, samples) : check_open(knots, samples);
}

Result<Eigen::MatrixXd> pseudo_inverse(const KnotVector& knots, std::span<const double> parameters) {
  const int controls = knots.control_point_count();
  const std::string samples = std::to_string(parameters.size()) + " samples";
  const std::string remedy = "; use at least " + std::to_string(2 * controls) + ", evenly spread";
  if (parameters.size() < static_cast<std::size_t>(controls)) {
    return Error{ErrorCode::too_few,
                 samples + " are too few for " + std::to_string(controls) + " control points" + remedy};
  }
  if (Status status = check_schoenberg_whitney(knots, parameters); !status) return status.error();

  std::optional<Eigen::MatrixXd> inverse =
      least_squares_inverse(blending_matrix(knots, parameters, 0).dense());
  if (!inverse) {
    return Error{ErrorCode::degenerate, samples + " at these parameters do not determine the " +
                                            std::to_string(controls) + " control points of degree " +
                                            std::to_string(knots.degree()) +
                                            (knots.is_periodic() ? " in a periodic direction" : "") + remedy};
  }
  return *std::move(inverse);
}

Result<Eigen::MatrixXd> constrained_inverse(const KnotVector& knots, std::span<const double> parameters,
                                            const RefitConstraints& constraints) {
  SPOONBILL_ASSERT(constraints.fixed_columns.empty() ||
                   constraints.fixed_columns.size() == static_cast<std::size_t>(knots.control_point_count()));
  SPOONBILL_ASSERT(!(constraints.keep_first || constraints.keep_last) || !knots.is_periodic());
  SPOONBILL_ASSERT(!(constraints.keep_first || constraints.keep_last) || !parameters.empty());
  const bool constrained =
      constraints.keep_first || constraints.keep_last || !constraints.fixed_columns.empty();
  if (!constrained) return pseudo_inverse(knots, parameters);
  const Eigen::MatrixXd a = blending_matrix(knots, parameters, 0).dense();
  const Eigen::Index samples = a.rows(), controls = a.cols();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(controls, samples);
  std::vector<Eigen::Index> free, interpolated;
  for (Eigen::Index c = 0; c < controls; ++c) {
    const bool fixed =
        !constraints.fixed_columns.empty() && constraints.fixed_columns[static_cast<std::size_t>(c)] != 0;
    if (fixed) continue;
    if ((constraints.keep_first && c == 0) || (constraints.keep_last && c == controls - 1)) {
      inverse(c, c == 0 ? 0 : samples - 1) = 1.0;
      interpolated.push_back(c);
    } else {
      free.push_back(c);
    }
  }
  if (free.empty()) return inverse;
  Eigen::MatrixXd free_columns(samples, static_cast<Eigen::Index>(free.size()));
  for (std::size_t f = 0; f < free.size(); ++f) {
    free_columns.col(static_cast<Eigen::Index>(f)) = a.col(free[f]);
  }
  const std::optional<Eigen::MatrixXd> fit = least_squares_inverse(free_columns);
  if (!fit)
    return Error{ErrorCode::degenerate,
                 "the samples do not determine the free control points; take more samples"};
  for (std::size_t f = 0; f < free.size(); ++f) inverse.row(free[f]) = fit->row(static_cast<Eigen::Index>(f));
  // An interpolated end control point copies its sample. Its contribution to the other samples is subtracted
  // before the free control points are fitted.
  for (const Eigen::Index c : interpolated) {
    const Eigen::Index sample = c == 0 ? 0 : samples - 1;
    for (std::size_t f = 0; f < free.size(); ++f) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < samples; ++k) {
        sum += (*fit)(static_cast<Eigen::Index>(f), k) * ((k == sample ? 1.0 : 0.0) - a(k, c));
      }
      inverse(free[f], sample) = sum;
    }
  }
  return inverse;
}

}  // namespace spoonbill
